// The bodies of a step as the driver over a law holds them: side by side, in the order in which their pairs
// act.
#pragma once
#include "rdpm/contacts/substeps.hpp"

namespace rdpm::contacts {

// Bands of one colour, in the order of their layers, with the bodies that drift with each; `rows` has room
// for one a band, and for one at least. Only the last band may reach over a periodic seam, to the first
// bodies.
inline Groups group_bodies(const Band* bands, std::int64_t count, const std::int32_t* ids,
                           std::int64_t bodies, Group* rows) {
    rows[0] = {{0, 0}, 0, bodies};
    if (count == 0) return {rows, 1, 0};
    std::int64_t lowest = bodies, highest = 0;
    for (std::int64_t n = 0; n < count; ++n) {
        rows[n] = {bands[n], highest, bodies};
        for (std::int64_t k = 2L * bands[n].from; k < 2L * bands[n].to; ++k) {
            if (ids[k] < 0) continue;
            if (n == 0) lowest = std::min<std::int64_t>(lowest, ids[k]);
            highest = std::max<std::int64_t>(highest, ids[k] + 1);
        }
        if (n > 0) rows[n - 1].last = rows[n].first;
    }
    rows[0].first = lowest;
    return {rows, count, lowest};
}

// All bodies, a row an id; non-contact force and torque instead of increments.
struct BodyTable {
    double *x, *v, *w, *rotation;
    const double *force, *torque, *inverse_mass, *inverse_moment, *radius;
    double *impulse, *angular_impulse, *contact_impulse;
};

// Doubles of room a body, and for all of them to begin at a line of the cache.
inline constexpr std::int64_t kBodyRoom = sizeof(BodyRow) / sizeof(double), kRoomToAlign = 7;

struct BodyRows {
    BodyRow* rows;
    std::int64_t count;
    const std::int32_t* ids;

    BodyRows(double* room, std::int64_t bodies, const std::int32_t* active) : count(bodies), ids(active) {
        const auto address = reinterpret_cast<std::uintptr_t>(room);
        rows = reinterpret_cast<BodyRow*>((address + alignof(BodyRow) - 1) / alignof(BodyRow) *
                                          alignof(BodyRow));
    }

    // The result: no two increments differ by more.
    double take(const BodyTable& all, double h, int threads) const {
        constexpr double none = std::numeric_limits<double>::infinity();
        double low[3] = {none, none, none}, high[3] = {-none, -none, -none};
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1) reduction(min : low) \
    reduction(max : high)
        for (std::int64_t k = 0; k < count; ++k) {
            const std::int64_t id = ids[k];
            BodyRow& b = rows[k];
            b.inverse_mass = all.inverse_mass[id];
            b.inverse_moment = all.inverse_moment[id];
            b.radius = all.radius[id];
            for (int d = 0; d < 3; ++d) {
                const std::int64_t c = 3 * id + d;
                b.x[d] = all.x[c];
                b.v[d] = all.v[c];
                b.w[d] = all.w[c];
                b.rotation[d] = all.rotation[c];
                b.impulse[d] = all.impulse[c];
                b.angular_impulse[d] = all.angular_impulse[c];
                b.contact_impulse[d] = all.contact_impulse[c];
                b.dv[d] = all.force[c] * (h * b.inverse_mass);
                b.dw[d] = all.torque[c] * (h * b.inverse_moment);
                low[d] = std::min(low[d], b.dv[d]);
                high[d] = std::max(high[d], b.dv[d]);
            }
        }
        if (count == 0) return 0;
        const double difference[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
        return std::sqrt(dot(difference, difference));
    }

    void give(const BodyTable& all, int threads) const {
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
        for (std::int64_t k = 0; k < count; ++k) {
            const BodyRow& b = rows[k];
            for (int d = 0; d < 3; ++d) {
                const std::int64_t c = 3L * ids[k] + d;
                all.x[c] = b.x[d];
                all.v[c] = b.v[d];
                all.w[c] = b.w[d];
                all.rotation[c] = b.rotation[d];
                all.impulse[c] = b.impulse[d];
                all.angular_impulse[c] = b.angular_impulse[d];
                all.contact_impulse[c] = b.contact_impulse[d];
            }
        }
    }
};

}  // namespace rdpm::contacts
