// Who may meet whom: a cell list, linear in the number of bodies, and the nearest surface of each body.
#pragma once
#include <limits>

#include "rdpm/contacts/pair.hpp"

namespace rdpm::contacts {

// Cells of at least `size` each way; `order` holds the bodies sorted by cell, `start` where each cell begins.
struct CellList {
    std::int64_t n[3];
    double inverse[3];
    bool is_periodic[3];
    std::int32_t *start, *order;

    static std::int64_t most_cells(std::int64_t bodies) { return 8 * bodies + 64; }

    static std::int64_t axis_cell(double x, double inverse, std::int64_t n) {
        const double c = x * inverse;
        if (!(c > 0)) return 0;  // also a body outside the box, or no number at all
        return c < static_cast<double>(n) ? static_cast<std::int64_t>(c) : n - 1;
    }
    std::int64_t cell_of(const double* x) const {
        return axis_cell(x[0], inverse[0], n[0]) +
               n[0] * (axis_cell(x[1], inverse[1], n[1]) + n[1] * axis_cell(x[2], inverse[2], n[2]));
    }
};

// start: most_cells + 1 entries; order: one a body. `is_even`: along a periodic z an even number, or one.
inline CellList sort_into_cells(const Box& box, const double* x, std::int64_t bodies, double size,
                                std::int32_t* start, std::int32_t* order, bool is_even) {
    CellList cells{};
    cells.start = start;
    cells.order = order;
    const double most = static_cast<double>(CellList::most_cells(bodies));
    for (int d = 0; d < 3; ++d) {
        cells.is_periodic[d] = box.period[d] > 0;
        cells.n[d] = static_cast<std::int64_t>(std::clamp(std::floor(box.size[d] / size), 1.0, most));
    }
    while (cells.n[0] * cells.n[1] * cells.n[2] > CellList::most_cells(bodies)) {
        std::int64_t* widest = std::max_element(cells.n, cells.n + 3);
        *widest = std::max<std::int64_t>(1, *widest / 2);
    }
    if (is_even && cells.is_periodic[2] && cells.n[2] > 1) cells.n[2] -= cells.n[2] % 2;
    for (int d = 0; d < 3; ++d) cells.inverse[d] = static_cast<double>(cells.n[d]) / box.size[d];
    const std::int64_t total = cells.n[0] * cells.n[1] * cells.n[2];
    std::fill(start, start + total + 1, 0);
    for (std::int64_t b = 0; b < bodies; ++b) ++start[cells.cell_of(x + 3 * b) + 1];
    for (std::int64_t c = 0; c < total; ++c) start[c + 1] += start[c];
    // Filled from behind, so that a cell's own entries of `start` serve as its cursor and end where they
    // began.
    for (std::int64_t b = bodies - 1; b >= 0; --b)
        order[--start[cells.cell_of(x + 3 * b) + 1]] = static_cast<std::int32_t>(b);
    for (std::int64_t c = 0; c < total; ++c) start[c] = start[c + 1];
    start[total] = static_cast<std::int32_t>(bodies);
    return cells;
}

// Calls visit(body) for every body in the cells at most `ring` cells away, each cell once.
template <class Visit>
void for_each_near(const CellList& cells, const double* x, std::int64_t ring, Visit&& visit) {
    std::int64_t low[3], high[3];
    for (int d = 0; d < 3; ++d) {
        const std::int64_t c = CellList::axis_cell(x[d], cells.inverse[d], cells.n[d]);
        low[d] = c - ring;
        high[d] = c + ring;
        if (!cells.is_periodic[d]) {
            low[d] = std::max<std::int64_t>(low[d], 0);
            high[d] = std::min(high[d], cells.n[d] - 1);
        } else if (high[d] - low[d] >= cells.n[d]) {
            low[d] = 0;
            high[d] = cells.n[d] - 1;
        }
    }
    const auto wrap = [&](std::int64_t c, int d) { return (c % cells.n[d] + cells.n[d]) % cells.n[d]; };
    for (std::int64_t k = low[2]; k <= high[2]; ++k)
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
            for (std::int64_t i = low[0]; i <= high[0]; ++i) {
                const std::int64_t c = wrap(i, 0) + cells.n[0] * (wrap(j, 1) + cells.n[1] * wrap(k, 2));
                for (std::int32_t at = cells.start[c]; at < cells.start[c + 1]; ++at) visit(cells.order[at]);
            }
}

inline double sphere_gap(const Box& box, const double* xi, const double* xj, double ai, double aj) {
    double r[3];
    nearest_image(box, xi, xj, r);
    return std::sqrt(dot(r, r)) - ai - aj;
}

// What the bodies may travel towards each other in dt: collisions may double a speed, so each is given twice
// the fastest.
inline double travel(const double* v, const double* force, const double* inverse_mass, std::int64_t bodies,
                     double dt) {
    double speed = 0, acceleration = 0;
    for (std::int64_t b = 0; b < bodies; ++b) {
        speed = std::max(speed, dot(v + 3 * b, v + 3 * b));
        acceleration =
            std::max(acceleration, dot(force + 3 * b, force + 3 * b) * inverse_mass[b] * inverse_mass[b]);
    }
    return 4 * dt * (std::sqrt(speed) + 0.5 * dt * std::sqrt(acceleration));
}

// Pairs with a gap of at most `range`, sorted by (i, j), i < j; walls are j = -1 - wall, those of a body
// before its spheres. Pairs in which neither can move are left out. Writes at most `capacity`, returns how
// many there are.
inline std::int64_t find_pairs(const Box& box, const double* x, const double* radius,
                               const double* inverse_mass, std::int64_t bodies, double range,
                               std::int32_t* start, std::int32_t* order, std::int32_t* pairs,
                               std::int64_t capacity) {
    double largest = 0;
    for (std::int64_t b = 0; b < bodies; ++b) largest = std::max(largest, radius[b]);
    const CellList cells = sort_into_cells(box, x, bodies, 2 * largest + range, start, order, false);
    std::int64_t found = 0;
    for (std::int64_t i = 0; i < bodies; ++i) {
        const double* xi = x + 3 * i;
        const auto add = [&](std::int64_t j) {
            if (found < capacity) {
                pairs[2 * found] = static_cast<std::int32_t>(i);
                pairs[2 * found + 1] = static_cast<std::int32_t>(j);
            }
            ++found;
        };
        if (inverse_mass[i] > 0)
            for_each_wall(box, [&](int wall) {
                if (wall_distance(box, xi, wall) - radius[i] <= range) add(-1 - wall);
            });
        const std::int64_t first = found;
        for_each_near(cells, xi, 1, [&](std::int32_t j) {
            if (j <= i || inverse_mass[i] + inverse_mass[j] == 0) return;
            if (sphere_gap(box, xi, x + 3L * j, radius[i], radius[j]) <= range) add(j);
        });
        if (found > capacity) continue;
        // Few a body: sorted by insertion.
        for (std::int64_t a = first + 1; a < found; ++a) {
            const std::int32_t j = pairs[2 * a + 1];
            std::int64_t at = a;
            for (; at > first && pairs[2 * at - 1] > j; --at) pairs[2 * at + 1] = pairs[2 * at - 1];
            pairs[2 * at + 1] = j;
        }
    }
    return found;
}

// Gap to the nearest surface and whose it is (a body, or a wall). What both arrays hold before stays
// where there is no surface nearer than that gap.
inline void nearest_surfaces(const Box& box, const double* x, const double* radius, std::int64_t bodies,
                             std::int32_t* start, std::int32_t* order, double* gap, std::int64_t* neighbour) {
    double largest = 0;
    for (std::int64_t b = 0; b < bodies; ++b) largest = std::max(largest, radius[b]);
    const CellList cells = sort_into_cells(box, x, bodies, 2 * largest, start, order, false);
    double width = std::numeric_limits<double>::infinity();
    std::int64_t most = 1;
    for (int d = 0; d < 3; ++d) {
        if (cells.n[d] > 1) width = std::min(width, 1 / cells.inverse[d]);
        most = std::max(most, cells.n[d]);
    }
    for (std::int64_t i = 0; i < bodies; ++i) {
        const double* xi = x + 3 * i;
        for_each_wall(box, [&](int wall) {
            const double g = wall_distance(box, xi, wall) - radius[i];
            if (!(g <= gap[i]) || std::isinf(g)) return;
            gap[i] = g;
            neighbour[i] = -1 - wall;
        });
        // Bodies beyond ring r are farther than r cells: their gap is known to be larger.
        for (std::int64_t ring = 1;; ring = 2 * ring) {
            for_each_near(cells, xi, ring, [&](std::int32_t j) {
                const double g = sphere_gap(box, xi, x + 3L * j, radius[i], radius[j]);
                if (j == i || g > gap[i] || (g == gap[i] && j > neighbour[i])) return;
                gap[i] = g;
                neighbour[i] = j;
            });
            if (ring >= most || static_cast<double>(ring) * width - radius[i] - largest >= gap[i]) break;
        }
    }
}

}  // namespace rdpm::contacts
