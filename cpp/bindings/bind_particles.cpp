#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_particles(nb::module_&) {}
