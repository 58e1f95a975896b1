// Bodies in the fluid: stencils of the markers, interpolation, spreading, sums over markers and over the
// inner fluid.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <array>
#include <memory>
#include <vector>

#include "check.hpp"
#include "rdpm/particles/close_surfaces.hpp"
#include "rdpm/particles/immersed_boundary.hpp"
#include "rdpm/particles/inner_fluid.hpp"
#include "rdpm/particles/marker_sums.hpp"

namespace nb = nanobind;
using namespace rdpm;

namespace {

using Values = Array<double>;
using Indices = Array<std::int32_t>;

double* field(const Grid& g, const Values& array, const char* name) {
    return checked(array, name, {g.nz() + 2, g.ny() + 2, g.nx() + 2});
}

// The stencils of all markers, kept between calls.
struct Markers {
    StencilSet set;

    Markers(const Grid& g, const Indices& first) : set(g, checked(first, "first", {-1}), last_of(first)) {}
    static int last_of(const Indices& first) {
        if (first.size() == 0) throw std::invalid_argument("first: needs one more than bodies");
        return static_cast<int>(first.shape(0)) - 1;
    }
    void place_at(const Grid& g, const Values& position) {
        const double* x = checked(position, "marker position", {set.count(), 3});
        nb::gil_scoped_release released;
        place(g, x, set);
    }
    void interpolate_to(const Grid& g, const Values& u, const Values& v, const Values& w,
                        const Values& out) const {
        const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        double* target = checked(out, "marker velocity", {set.count(), 3});
        nb::gil_scoped_release released;
        interpolate(g, q, set, target);
    }
    void spread_from(const Grid& g, const Values& u, const Values& v, const Values& w, const Values& value,
                     const Values& volume, double factor) const {
        const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        const double *values = checked(value, "marker value", {set.count(), 3}),
                     *volumes = checked(volume, "volume", {set.count()});
        nb::gil_scoped_release released;
        spread(g, q, set, values, volumes, factor);
    }
    void inner_motion_of(const Grid& g, const Values& u, const Values& v, const Values& w,
                         const Values& position, const Values& radius, const Values& out) const {
        const VelocityArrays q{field(g, u, "u"), field(g, v, "v"), field(g, w, "w")};
        const int bodies = set.bodies();
        const double *x = checked(position, "position", {bodies, 3}),
                     *a = checked(radius, "radius", {bodies});
        double* motion = checked(out, "inner motion", {bodies, 6});
        nb::gil_scoped_release released;
        inner_motion(g, q, set, x, a, motion);
    }
};

}  // namespace

void bind_particles(nb::module_& module) {
    nb::class_<Markers>(module, "Markers", "Stencils of the markers at their present places.")
        .def(nb::init<const Grid&, const Indices&>())
        .def("place", &Markers::place_at)
        .def("interpolate", &Markers::interpolate_to)
        .def("spread", &Markers::spread_from)
        .def("inner_motion", &Markers::inner_motion_of)
        .def_prop_ro("count", [](const Markers& self) { return self.set.count(); });
    module.def("sum_over_markers", [](const Indices& first, const Values& arm, const Values& volume,
                                      const Values& value, int threads, const Values& out) {
        const int bodies = static_cast<int>(first.shape(0)) - 1;
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        const double *r = checked(arm, "arm", {n, 3}), *dv = checked(volume, "volume", {n}),
                     *x = checked(value, "value", {n, 3});
        double* sums = checked(out, "sums", {bodies, 6});
        nb::gil_scoped_release released;
        sum_over_markers(bodies, f, r, dv, x, threads, sums);
    });
    module.def("move_markers", [](const Indices& first, const Values& orientation, const Values& centre,
                                  const Values& body_arm, const Values& body_force, int threads,
                                  const Values& arm, const Values& position, const Values& force) {
        const int bodies = static_cast<int>(first.shape(0)) - 1;
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        const double *o = checked(orientation, "orientation", {bodies, 4}),
                     *x = checked(centre, "centre", {bodies, 3}),
                     *r_body = checked(body_arm, "body arm", {n, 3}),
                     *f_body = checked(body_force, "body force", {n, 3});
        double *r = checked(arm, "arm", {n, 3}), *at = checked(position, "position", {n, 3}),
               *given = checked(force, "force", {n, 3});
        nb::gil_scoped_release released;
        move_markers(bodies, f, o, x, r_body, f_body, threads, r, at, given);
    });
    module.def("keep_forces", [](const Indices& first, const Values& orientation, double share, int threads,
                                 const Values& force, const Values& body_force) {
        const int bodies = static_cast<int>(first.shape(0)) - 1;
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        const double* o = checked(orientation, "orientation", {bodies, 4});
        double *given = checked(force, "force", {n, 3}), *f_body = checked(body_force, "body force", {n, 3});
        nb::gil_scoped_release released;
        keep_forces(bodies, f, o, share, threads, given, f_body);
    });
    module.def("rigid_change", [](const Indices& first, const Values& arm, const Values& volume,
                                  const Values& velocity, const Values& spin, double inverse_dt, int threads,
                                  const Values& change, const Values& force, const Values& out) {
        const int bodies = static_cast<int>(first.shape(0)) - 1;
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        const double *r = checked(arm, "arm", {n, 3}), *dv = checked(volume, "volume", {n}),
                     *v = checked(velocity, "velocity", {bodies, 3}),
                     *o = checked(spin, "angular velocity", {bodies, 3});
        double *c = checked(change, "change", {n, 3}), *total = checked(force, "force", {n, 3}),
               *sums = checked(out, "sums", {bodies, 7});
        nb::gil_scoped_release released;
        rigid_change(bodies, f, r, dv, v, o, inverse_dt, threads, c, total, sums);
    });
    module.def("marker_moments", [](const Indices& first, const Values& arm, const Values& volume,
                                    int threads, const Values& out) {
        const int bodies = static_cast<int>(first.shape(0)) - 1;
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        const double *r = checked(arm, "arm", {n, 3}), *dv = checked(volume, "volume", {n});
        double* moments = checked(out, "moments", {bodies, 10});
        nb::gil_scoped_release released;
        marker_moments(bodies, f, r, dv, threads, moments);
    });
    module.def("stand_back", [](const std::array<double, 3>& size, const std::array<bool, 3>& is_periodic,
                                const std::array<bool, 3>& is_solid, const std::array<double, 4>& retreat,
                                const Indices& pairs, const Indices& first, const Values& marker,
                                const Values& centre, const Values& radius, const Values& full, int threads,
                                const Values& volume) {
        const int bodies = static_cast<int>(first.shape(0)) - 1, n_pairs = static_cast<int>(pairs.shape(0));
        const std::int32_t* f = checked(first, "first", {bodies + 1});
        const int n = f[bodies];
        Surroundings around{{size[0], size[1], size[2]},
                            {is_periodic[0], is_periodic[1], is_periodic[2]},
                            {is_solid[0], is_solid[1], is_solid[2]},
                            checked(pairs, "pairs", {n_pairs, 2}),
                            n_pairs};
        const double *x = checked(marker, "marker", {n, 3}), *c = checked(centre, "centre", {bodies, 3}),
                     *a = checked(radius, "radius", {bodies}), *whole = checked(full, "full volume", {n});
        double* kept = checked(volume, "volume", {n});
        nb::gil_scoped_release released;
        stand_back(around, {retreat[0], retreat[1], retreat[2], retreat[3]}, bodies, f, x, c, a, whole,
                   threads, kept);
    });
}
