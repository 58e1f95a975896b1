// The machine: memory bandwidth with the threads the solver uses.
#include <nanobind/nanobind.h>

#include <memory>
#include <stdexcept>

#include "rdpm/parallel/triad.hpp"

namespace nb = nanobind;

void bind_parallel(nb::module_& module) {
    module.def("triad_seconds", [](std::ptrdiff_t elements, int threads, int sweeps) {
        if (elements < 1 || threads < 1 || sweeps < 1)
            throw std::invalid_argument("triad: all arguments must be >= 1");
        const auto array = [&] {
            return std::unique_ptr<double[]>(new double[elements]);
        };  // not touched yet
        const auto a = array(), b = array(), c = array();
        nb::gil_scoped_release released;
        return rdpm::triad_seconds(a.get(), b.get(), c.get(), elements, threads, sweeps);
    });
}
