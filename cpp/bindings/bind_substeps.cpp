// Contacts that last: sub-steps of the bodies that have a pair, and the end of a step. Python owns every
// array; rooms of scratch come from there too.
#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include <limits>
#include <tuple>
#include <vector>

#include "contact_arguments.hpp"
#include "rdpm/contacts/body_rows.hpp"
#include "rdpm/contacts/motion.hpp"

namespace nb = nanobind;
using rdpm::Bytes;
using rdpm::checked_bodies;
using rdpm::checked_bytes;
using rdpm::checked_pairs;
using rdpm::checked_rows;
using rdpm::ConstBytes;
using rdpm::In;
using rdpm::InOut;
using rdpm::make_box;
using rdpm::Reals;
namespace contacts = rdpm::contacts;

namespace {

// Pairs of a selection: rows of the table, bands that follow each other in it.
const std::int32_t* checked_selection(const In<std::int32_t>& rows, const In<std::int32_t>& bands,
                                      std::int64_t pairs, std::int64_t table) {
    const std::int32_t* row = rows.checked("rows", {pairs});
    for (std::int64_t k = 0; k < pairs; ++k)
        rdpm::require(row[k] >= (k > 0 ? row[k - 1] + 1 : 0) && row[k] < table,
                      "rows: must rise, below the number of pairs");
    const std::int64_t count = bands.rows("bands", {-1, 2});
    const std::int32_t* band = bands.checked("bands", {count, 2});
    std::int64_t covered = 0;
    for (std::int64_t k = 0; k < count; ++k) {
        rdpm::require(band[2 * k] >= 0 && band[2 * k] <= band[2 * k + 1] && band[2 * k + 1] <= pairs,
                      "bands: must lie within the pairs");
        covered += band[2 * k + 1] - band[2 * k];
    }
    rdpm::require(covered == pairs, "bands: must hold every pair once");
    return row;
}

std::tuple<std::int64_t, std::int64_t, std::int64_t, double, double> run_substeps(
    const contacts::Kernel& kernel, const Reals& box, const InOut<double>& position,
    const InOut<double>& velocity, const InOut<double>& angular_velocity, const InOut<double>& rotation,
    const Reals& force, const Reals& torque, const Reals& inverse_mass, const Reals& inverse_moment,
    const Reals& radius, const InOut<double>& impulse, const InOut<double>& angular_impulse,
    const InOut<double>& contact_impulse, const InOut<double>& lubrication_angular_impulse,
    const In<std::int32_t>& active, const In<std::int32_t>& pairs, const In<std::int32_t>& rows,
    const In<std::int32_t>& bands, std::int64_t even_bands, const In<std::int32_t>& kinds,
    const ConstBytes& parameters, const ConstBytes& lubrication, const Bytes& state, const Bytes& history,
    const Bytes& finished, const InOut<double>& body_room, const InOut<std::int32_t>& pair_room,
    double closing, double time, double h, double overlap_limit, std::int64_t first, std::int64_t last,
    int threads) {
    const auto n = position.rows("position", {-1, 3});
    const auto m = state.rows("state", {-1, sizeof(contacts::ContactState)});
    const auto actives = active.rows("active", {-1}), selected = pairs.rows("pairs", {-1, 2});
    rdpm::require(threads >= 1, "threads: must be at least 1");
    const contacts::BodyTable all{position.checked("position", {n, 3}),
                                  velocity.checked("velocity", {n, 3}),
                                  angular_velocity.checked("angular_velocity", {n, 3}),
                                  rotation.checked("rotation", {n, 3}),
                                  force.checked("force", {n, 3}),
                                  torque.checked("torque", {n, 3}),
                                  inverse_mass.checked("inverse_mass", {n}),
                                  inverse_moment.checked("inverse_moment", {n}),
                                  radius.checked("radius", {n}),
                                  impulse.checked("impulse", {n, 3}),
                                  angular_impulse.checked("angular_impulse", {n, 3}),
                                  contact_impulse.checked("contact_impulse", {n, 3})};
    const contacts::BodyRows bodies{body_room.checked("body_room", {-1}), actives,
                                    checked_bodies(active, "active", actives, n)};
    rdpm::require(body_room.rows("body_room", {-1}) >= contacts::kBodyRoom * actives + contacts::kRoomToAlign,
                  "body_room: too small");
    std::int32_t* wake = pair_room.checked("pair_room", {-1});
    rdpm::require(pair_room.rows("pair_room", {-1}) >= 2 * selected, "pair_room: too small");
    const std::int32_t* row = checked_selection(rows, bands, selected, m);
    const std::int64_t kind_count =
        parameters.rows("parameters", {-1, static_cast<std::int64_t>(kernel.parameters.size)});
    const std::int32_t* kind = kinds.checked("kinds", {m});
    for (std::int64_t k = 0; k < m; ++k)
        rdpm::require(kind[k] >= 0 && kind[k] < kind_count, "kinds: must be rows of the parameters");
    const std::int64_t band_count = bands.rows("bands", {-1, 2});
    rdpm::require(even_bands >= 0 && even_bands <= band_count, "even_bands: must lie within the bands");
    const bool is_wet = lubrication.rows("lubrication", {-1, sizeof(contacts::LubricationRow)}) > 0;
    const contacts::PairArrays rows_of_pairs{
        checked_pairs(pairs, "pairs", selected, actives, make_box(box)),
        checked_bytes(parameters, "parameters", -1, kernel.parameters.size),
        is_wet ? checked_rows<contacts::LubricationRow>(lubrication, "lubrication", m) : nullptr,
        checked_rows<contacts::ContactState>(state, "state", m),
        checked_bytes(history, "history", m, kernel.history.size),
        selected};
    contacts::SubstepTask task{{bodies.rows},
                               actives,
                               make_box(box),
                               rows_of_pairs,
                               row,
                               kind,
                               {},
                               wake,
                               wake + selected,
                               0,
                               1 / (h * closing),
                               nullptr,
                               checked_rows<contacts::Finished>(finished, "finished", -1),
                               finished.rows("finished", {-1, sizeof(contacts::Finished)}),
                               time,
                               h,
                               overlap_limit,
                               first,
                               last,
                               threads};
    const auto* all_bands = reinterpret_cast<const contacts::Band*>(bands.checked("bands", {-1, 2}));
    double* all_turned = lubrication_angular_impulse.checked("lubrication_angular_impulse", {n, 3});
    nb::gil_scoped_release unlocked;
    std::vector<contacts::Group> groups(static_cast<std::size_t>(band_count) + 2);
    task.groups[0] = contacts::group_bodies(all_bands, even_bands, task.pairs.ids, actives, groups.data());
    task.groups[1] = contacts::group_bodies(all_bands + even_bands, band_count - even_bands, task.pairs.ids,
                                            actives, groups.data() + even_bands + 1);
    std::vector<double> turned(is_wet ? static_cast<std::size_t>(3 * actives) : 0);
    task.turned = turned.data();
    task.acceleration = bodies.take(all, h, threads);
    for (std::int64_t k = 0; k < selected; ++k)
        wake[k] = rows_of_pairs.state[row[k]].phase == contacts::kApart ? 0 : contacts::kUnderWay;
    const contacts::Progress p = kernel.run(task);
    bodies.give(all, threads);
    for (std::size_t c = 0; c < turned.size(); ++c) all_turned[3L * bodies.ids[c / 3] + c % 3] += turned[c];
    return {p.next, p.finished, p.failed, p.min_gap, p.max_overlap};
}

void end_step(const Reals& box, const InOut<double>& position, const InOut<double>& velocity,
              const InOut<double>& angular_velocity, const InOut<double>& orientation,
              const InOut<std::int64_t>& crossings, const InOut<double>& rotation, const Reals& force,
              const Reals& torque, const Reals& inverse_mass, const Reals& inverse_moment,
              const In<bool>& is_active, double dt, int threads) {
    const auto n = position.rows("position", {-1, 3});
    rdpm::require(threads >= 1, "threads: must be at least 1");
    const contacts::Box b = make_box(box);
    double *x = position.checked("position", {n, 3}), *v = velocity.checked("velocity", {n, 3});
    double *w = angular_velocity.checked("angular_velocity", {n, 3}),
           *q = orientation.checked("orientation", {n, 4});
    std::int64_t* crossed = crossings.checked("crossings", {n, 3});
    double* r = rotation.checked("rotation", {n, 3});
    const double *f = force.checked("force", {n, 3}), *t = torque.checked("torque", {n, 3});
    const double *m = inverse_mass.checked("inverse_mass", {n}),
                 *i = inverse_moment.checked("inverse_moment", {n});
    const bool* moved = is_active.checked("is_active", {n});
    nb::gil_scoped_release unlocked;
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
    for (std::int64_t k = 0; k < n; ++k) {
        if (!moved[k])
            contacts::fly(x + 3 * k, v + 3 * k, w + 3 * k, r + 3 * k, f + 3 * k, t + 3 * k, m[k], i[k], dt);
        contacts::settle(b, x + 3 * k, q + 4 * k, crossed + 3 * k, r + 3 * k);
    }
}

// Contacts under way: how many there are, the largest overlap; the largest speed at touch of each body's.
std::tuple<std::int64_t, double> contacts_under_way(const Reals& box, const In<std::int32_t>& pairs,
                                                    const ConstBytes& state,
                                                    const InOut<double>& impact_speed) {
    const auto m = pairs.rows("pairs", {-1, 2}), n = impact_speed.rows("impact_speed", {-1});
    const std::int32_t* id =
        checked_pairs(pairs, "pairs", m, std::numeric_limits<std::int32_t>::max(), make_box(box));
    for (std::int64_t k = 0; k < 2 * m; ++k)
        rdpm::require(id[k] < n, "impact_speed: must have a value for each body of the pairs");
    const auto* s = checked_rows<contacts::ContactState>(state, "state", m);
    double* speed = impact_speed.checked("impact_speed", {n});
    nb::gil_scoped_release unlocked;
    std::int64_t count = 0;
    double overlap = 0;
    for (std::int64_t k = 0; k < m; ++k) {
        if (s[k].phase == contacts::kApart) continue;
        ++count;
        overlap = std::max(overlap, s[k].overlap);
        for (int side = 0; side < 2; ++side)
            if (id[2 * k + side] >= 0)
                speed[id[2 * k + side]] = std::max(speed[id[2 * k + side]], s[k].impact_speed);
    }
    return {count, overlap};
}

}  // namespace

void bind_substeps(nb::module_& module) {
    module.def("run_substeps", &run_substeps, nb::arg("kernel"), nb::arg("box"), nb::arg("position"),
               nb::arg("velocity"), nb::arg("angular_velocity"), nb::arg("rotation"), nb::arg("force"),
               nb::arg("torque"), nb::arg("inverse_mass"), nb::arg("inverse_moment"), nb::arg("radius"),
               nb::arg("impulse"), nb::arg("angular_impulse"), nb::arg("contact_impulse"),
               nb::arg("lubrication_angular_impulse"), nb::arg("active"), nb::arg("pairs"), nb::arg("rows"),
               nb::arg("bands"), nb::arg("even_bands"), nb::arg("kinds"), nb::arg("parameters"),
               nb::arg("lubrication"), nb::arg("state"), nb::arg("history"), nb::arg("finished"),
               nb::arg("body_room"), nb::arg("pair_room"), nb::arg("closing"), nb::arg("time"), nb::arg("h"),
               nb::arg("overlap_limit"), nb::arg("first"), nb::arg("last"), nb::arg("threads"));
    module.def("end_step", &end_step, nb::arg("box"), nb::arg("position"), nb::arg("velocity"),
               nb::arg("angular_velocity"), nb::arg("orientation"), nb::arg("crossings"), nb::arg("rotation"),
               nb::arg("force"), nb::arg("torque"), nb::arg("inverse_mass"), nb::arg("inverse_moment"),
               nb::arg("is_active"), nb::arg("dt"), nb::arg("threads"));
    module.def("contacts_under_way", &contacts_under_way, nb::arg("box"), nb::arg("pairs"), nb::arg("state"),
               nb::arg("impact_speed"));
}
