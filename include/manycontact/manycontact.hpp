#pragma once
// All it takes to load or build a scene, solve it, differentiate it and follow it through time. Crocoddyl's action
// model and its optimal control have headers of their own, manycontact/action.hpp and manycontact/control.hpp.

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/analysis/consistent.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/contact/reference.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/report.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/solve_wanted.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/io/urdf.hpp"
#include "manycontact/model/scene.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/simulation/switch.hpp"
#include "manycontact/version.hpp"
