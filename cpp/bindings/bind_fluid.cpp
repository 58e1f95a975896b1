#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_fluid(nb::module_&) {}
