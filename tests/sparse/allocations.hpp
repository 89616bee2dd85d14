#pragma once
#include "support/allocations.hpp"
