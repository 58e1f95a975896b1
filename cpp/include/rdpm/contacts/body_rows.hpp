// The bodies of a step as the driver over a law holds them: side by side, in the order in which their pairs
// act.
#pragma once
#include "rdpm/contacts/substeps.hpp"

namespace rdpm::contacts {

inline constexpr std::int64_t kBodyColumns = 30;  // of room

// All bodies, a row an id; non-contact force and torque instead of increments.
struct BodyTable {
    double *x, *v, *w, *rotation;
    const double *force, *torque, *inverse_mass, *inverse_moment, *radius;
    double *impulse, *angular_impulse, *contact_impulse;
};

struct BodyRows {
    double* room;  // (kBodyColumns * count,)
    std::int64_t count;
    const std::int32_t* ids;

    double* column(std::int64_t n) const { return room + 3 * n * count; }
    double* scalar(std::int64_t n) const { return room + (27 + n) * count; }

    BodyArrays arrays() const {
        return {column(0), column(1), column(2), column(3), column(4), column(5),
                scalar(0), scalar(1), scalar(2), column(6), column(7), column(8)};
    }

    void take(const BodyTable& all, double h, int threads) const {
        double* const to[9] = {column(0), column(1), column(2), column(3), column(6),
                               column(7), column(8), column(4), column(5)};
        const double* const from[9] = {
            all.x,     all.v,     all.w, all.rotation, all.impulse, all.angular_impulse, all.contact_impulse,
            all.force, all.torque};
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
        for (std::int64_t k = 0; k < count; ++k) {
            const std::int64_t id = ids[k];
            for (int n = 0; n < 9; ++n)
                for (int d = 0; d < 3; ++d) to[n][3 * k + d] = from[n][3 * id + d];
            scalar(0)[k] = all.inverse_mass[id];
            scalar(1)[k] = all.inverse_moment[id];
            scalar(2)[k] = all.radius[id];
            for (int d = 0; d < 3; ++d) {
                column(4)[3 * k + d] *= h * all.inverse_mass[id];
                column(5)[3 * k + d] *= h * all.inverse_moment[id];
            }
        }
    }

    void give(const BodyTable& all, int threads) const {
        double* const to[7] = {
            all.x, all.v, all.w, all.rotation, all.impulse, all.angular_impulse, all.contact_impulse};
        const double* const from[7] = {column(0), column(1), column(2), column(3),
                                       column(6), column(7), column(8)};
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
        for (std::int64_t k = 0; k < count; ++k)
            for (int n = 0; n < 7; ++n)
                for (int d = 0; d < 3; ++d) to[n][3L * ids[k] + d] = from[n][3 * k + d];
    }

    // No two increments differ by more than this.
    double largest_difference() const {
        double low[3], high[3], difference[3];
        const double* dv = column(4);
        for (int d = 0; d < 3; ++d) low[d] = high[d] = count > 0 ? dv[d] : 0;
        for (std::int64_t k = 1; k < count; ++k)
            for (int d = 0; d < 3; ++d) {
                low[d] = std::min(low[d], dv[3 * k + d]);
                high[d] = std::max(high[d], dv[3 * k + d]);
            }
        for (int d = 0; d < 3; ++d) difference[d] = high[d] - low[d];
        return std::sqrt(dot(difference, difference));
    }
};

}  // namespace rdpm::contacts
