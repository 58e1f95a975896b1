// Contacts: who may meet whom. Python owns every array; rooms of scratch come from there too.
#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "contact_arguments.hpp"
#include "rdpm/contacts/neighbour_list.hpp"
#include "rdpm/contacts/substeps.hpp"

namespace nb = nanobind;
using rdpm::checked_bodies;
using rdpm::checked_pairs;
using rdpm::checked_rows;
using rdpm::ConstBytes;
using rdpm::In;
using rdpm::InOut;
using rdpm::make_box;
using rdpm::Reals;
namespace contacts = rdpm::contacts;

namespace {

std::int64_t find_pairs(const Reals& box, const Reals& position, const Reals& velocity, const Reals& force,
                        const Reals& radius, const Reals& inverse_mass, double dt, double margin,
                        const InOut<std::int32_t>& cell_start, const InOut<std::int32_t>& cell_order,
                        const InOut<std::int32_t>& pairs) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *v = velocity.checked("velocity", {n, 3});
    const double *f = force.checked("force", {n, 3}), *a = radius.checked("radius", {n});
    const double* m = inverse_mass.checked("inverse_mass", {n});
    std::int32_t* start = cell_start.checked("cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = cell_order.checked("cell_order", {n});
    std::int32_t* out = pairs.checked("pairs", {-1, 2});
    const auto capacity = pairs.rows("pairs", {-1, 2});
    nb::gil_scoped_release unlocked;
    const double range = margin + contacts::travel(v, f, m, n, dt);
    return contacts::find_pairs(b, x, a, m, n, range, start, order, out, capacity);
}

void nearest_surfaces(const Reals& box, const Reals& position, const Reals& radius,
                      const InOut<std::int32_t>& cell_start, const InOut<std::int32_t>& cell_order,
                      const InOut<double>& gap, const InOut<std::int64_t>& neighbour) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *a = radius.checked("radius", {n});
    std::int32_t* start = cell_start.checked("cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t* order = cell_order.checked("cell_order", {n});
    double* g = gap.checked("gap", {n});
    std::int64_t* j = neighbour.checked("neighbour", {n});
    nb::gil_scoped_release unlocked;
    contacts::nearest_surfaces(b, x, a, n, start, order, g, j);
}

// How far bodies may travel towards each other in dt, and how far one has moved since they were at `old`.
std::tuple<double, double> list_demand(const Reals& box, const Reals& position, const Reals& velocity,
                                       const Reals& force, const Reals& inverse_mass, const Reals& old,
                                       double dt) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *v = velocity.checked("velocity", {n, 3});
    const double *f = force.checked("force", {n, 3}), *m = inverse_mass.checked("inverse_mass", {n});
    const double* from = old.checked("old", {n, 3});
    nb::gil_scoped_release unlocked;
    return {contacts::travel(v, f, m, n, dt), contacts::displacement(b, from, x, n)};
}

std::int64_t list_pairs(const Reals& box, const Reals& position, const Reals& radius,
                        const Reals& inverse_mass, double range, const InOut<std::int32_t>& cell_start,
                        const InOut<std::int32_t>& order, const InOut<std::int32_t>& rank,
                        const InOut<std::int32_t>& pairs, const InOut<std::int32_t>& layer) {
    const std::int64_t n = position.rows("position", {-1, 3});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *a = radius.checked("radius", {n});
    const double* m = inverse_mass.checked("inverse_mass", {n});
    std::int32_t* start = cell_start.checked("cell_start", {contacts::CellList::most_cells(n) + 1});
    std::int32_t *sorted = order.checked("order", {n}), *place = rank.checked("rank", {n});
    const auto capacity = pairs.rows("pairs", {-1, 2});
    std::int32_t* out = pairs.checked("pairs", {capacity, 2});
    std::int32_t* layers = layer.checked("layer", {capacity});
    nb::gil_scoped_release unlocked;
    const contacts::Ranks ranks = contacts::rank_bodies(b, x, a, n, range, start, sorted, place);
    return contacts::list_pairs(b, x, a, m, n, range, ranks, out, layers, capacity);
}

std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t, double> select_pairs(
    const Reals& box, const Reals& position, const Reals& radius, double range, const In<std::int32_t>& order,
    const In<std::int32_t>& pairs, const In<std::int32_t>& layer, const Reals& times, const ConstBytes& state,
    const InOut<std::int32_t>& rows, const InOut<std::int32_t>& local, const InOut<std::int32_t>& active,
    const InOut<std::int32_t>& place, const InOut<std::int32_t>& bands) {
    const std::int64_t n = position.rows("position", {-1, 3}), m = pairs.rows("pairs", {-1, 2});
    const contacts::Box b = make_box(box);
    const double *x = position.checked("position", {n, 3}), *a = radius.checked("radius", {n});
    const std::int32_t* sorted = checked_bodies(order, "order", order.rows("order", {n}), n);
    const std::int32_t* ids = checked_pairs(pairs, "pairs", m, n, b);
    const std::int32_t* layers = layer.checked("layer", {m});
    const double* time = times.checked("times", {m});
    const auto* states = checked_rows<contacts::ContactState>(state, "state", m);
    const contacts::SelectionArrays out{rows.checked("rows", {m}), local.checked("local", {m, 2}),
                                        active.checked("active", {n}), place.checked("place", {n}),
                                        bands.checked("bands", {m, 2})};
    nb::gil_scoped_release unlocked;
    const contacts::Selection s = contacts::select_pairs(
        b, x, a, n, range, sorted, ids, layers, time, m,
        [&](std::int64_t k) { return states[k].phase != contacts::kApart; }, out);
    return {s.pairs, s.bodies, s.even_bands, s.bands, s.lost, s.shortest};
}

}  // namespace

void bind_neighbours(nb::module_& module) {
    module.def("find_pairs", &find_pairs, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("force"), nb::arg("radius"), nb::arg("inverse_mass"), nb::arg("dt"), nb::arg("margin"),
               nb::arg("cell_start"), nb::arg("cell_order"), nb::arg("pairs"));
    module.def("nearest_surfaces", &nearest_surfaces, nb::arg("box"), nb::arg("position"), nb::arg("radius"),
               nb::arg("cell_start"), nb::arg("cell_order"), nb::arg("gap"), nb::arg("neighbour"));
    module.def("list_demand", &list_demand, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("force"), nb::arg("inverse_mass"), nb::arg("old"), nb::arg("dt"));
    module.def("list_pairs", &list_pairs, nb::arg("box"), nb::arg("position"), nb::arg("radius"),
               nb::arg("inverse_mass"), nb::arg("range"), nb::arg("cell_start"), nb::arg("order"),
               nb::arg("rank"), nb::arg("pairs"), nb::arg("layer"));
    module.def("select_pairs", &select_pairs, nb::arg("box"), nb::arg("position"), nb::arg("radius"),
               nb::arg("range"), nb::arg("order"), nb::arg("pairs"), nb::arg("layer"), nb::arg("times"),
               nb::arg("state"), nb::arg("rows"), nb::arg("local"), nb::arg("active"), nb::arg("place"),
               nb::arg("bands"));
}
