// The extension module: one bind_<room>.cpp a room.
#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_fluid(nb::module_& module);
void bind_particles(nb::module_& module);
void bind_contacts(nb::module_& module);
void bind_neighbours(nb::module_& module);
void bind_substeps(nb::module_& module);
void bind_parallel(nb::module_& module);

NB_MODULE(_core, module) {
    module.doc() = "Loops over arrays: the numerical kernels of rdpm.";
    bind_fluid(module);
    bind_particles(module);
    bind_contacts(module);
    bind_neighbours(module);
    bind_substeps(module);
    bind_parallel(module);
}
