// Retalho's errors as Python exceptions: Error, and below it UsageError and BadInput (also ValueError), CannotRead and
// CannotWrite (also OSError). Interrupted becomes KeyboardInterrupt.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

/// Adds the exception classes to the module and has them raised from C++.
void add_errors(pybind11::module_& module);

}  // namespace retalho::python
