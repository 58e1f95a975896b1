// The machine: memory bandwidth with the threads the solver uses.
#include <nanobind/nanobind.h>

#include <memory>

#include "check.hpp"
#include "rdpm/parallel/triad.hpp"

namespace nb = nanobind;
using namespace nb::literals;

void bind_parallel(nb::module_& module) {
    module.def(
        "triad_seconds",
        [](std::ptrdiff_t elements, int threads, int sweeps) {
            rdpm::require(elements >= 1, "elements: must be >= 1");
            rdpm::require(threads >= 1, "threads: must be >= 1");
            rdpm::require(sweeps >= 1, "sweeps: must be >= 1");
            const auto array = [&] {
                return std::unique_ptr<double[]>(new double[elements]);
            };  // not touched yet
            const auto a = array(), b = array(), c = array();
            nb::gil_scoped_release released;
            return rdpm::triad_seconds(a.get(), b.get(), c.get(), elements, threads, sweeps);
        },
        "elements"_a, "threads"_a, "sweeps"_a);
}
