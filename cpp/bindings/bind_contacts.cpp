#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_contacts(nb::module_&) {}
