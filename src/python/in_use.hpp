#pragma once
// Batches, which one thread uses at a time.

#include <set>
#include <string>

#include "objects.hpp"

namespace manycontact::python {

/// Marks a batch as in use during its own lifetime, which begins and ends while the GIL is held. Throws ValueError if
/// another thread uses the batch.
class InUse {
 public:
  template <class Batch>
  InUse(const Batch& batch, const char* type) : batch_(&batch) {
    if (!all_.insert(batch_).second)
      throw py::value_error("the batch is in use by another thread: use separate " + std::string(type) +
                            " in each thread");
  }
  ~InUse() { all_.erase(batch_); }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  inline static std::set<const void*> all_;
  const void* batch_;
};

}  // namespace manycontact::python
