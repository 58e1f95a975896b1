// Pairs that may meet as long as no body has moved far, in an order that follows from where the bodies are,
// and those of them that may meet in one step.
#pragma once
#include <bit>

#include "rdpm/contacts/neighbours.hpp"

namespace rdpm::contacts {

// Bodies sorted by cell, those of a cell by position (z, y, x): `rank` is a body's place in that order,
// whatever its id.
struct Ranks {
    CellList cells;
    std::int32_t* rank;

    std::int64_t layer(const double* x) const {
        return CellList::axis_cell(x[2], cells.inverse[2], cells.n[2]);
    }
};

// Rises with the value, and orders also what is no number.
inline std::int64_t sortable(double value) {
    const auto bits = std::bit_cast<std::int64_t>(value);
    return bits ^ ((bits >> 63) & std::numeric_limits<std::int64_t>::max());
}

inline bool is_before(const double* a, const double* b) {
    for (int d = 2; d > 0; --d)
        if (a[d] != b[d]) return sortable(a[d]) < sortable(b[d]);
    return sortable(a[0]) < sortable(b[0]);
}

// Layers of cells along z are bands: a pair lies in one or in two that touch. Along a periodic z their number
// is even or one, so that they alternate all around.
inline Ranks rank_bodies(const Box& box, const double* x, const double* radius, std::int64_t bodies,
                         double range, std::int32_t* start, std::int32_t* order, std::int32_t* rank) {
    double largest = 0;
    for (std::int64_t b = 0; b < bodies; ++b) largest = std::max(largest, radius[b]);
    const CellList cells = sort_into_cells(box, x, bodies, 2 * largest + range, start, order, true);
    const std::int64_t total = cells.n[0] * cells.n[1] * cells.n[2];
    for (std::int64_t c = 0; c < total; ++c)
        if (start[c + 1] - start[c] > 1)
            std::sort(order + start[c], order + start[c + 1],
                      [&](std::int32_t a, std::int32_t b) { return is_before(x + 3L * a, x + 3L * b); });
    for (std::int64_t r = 0; r < bodies; ++r) rank[order[r]] = static_cast<std::int32_t>(r);
    return {cells, rank};
}

// Pairs with a gap of at most `range`, by the rank of the lower body (across the seam the one in the last
// layer), then walls before spheres by rank. Ids i < j, or a wall -1 - w; `layer` is the lower body's. Pairs
// in which neither can move are left out. Writes at most `capacity`, returns how many there are.
inline std::int64_t list_pairs(const Box& box, const double* x, const double* radius,
                               const double* inverse_mass, std::int64_t bodies, double range,
                               const Ranks& ranks, std::int32_t* pairs, std::int32_t* layers,
                               std::int64_t capacity) {
    const CellList& cells = ranks.cells;
    const std::int64_t last = cells.n[2] - 1;
    std::int64_t found = 0;
    for (std::int64_t r = 0; r < bodies; ++r) {
        const std::int32_t i = cells.order[r];
        const double* xi = x + 3L * i;
        const std::int64_t layer = ranks.layer(xi);
        const auto add = [&](std::int64_t j) {
            if (found < capacity) {
                pairs[2 * found] = i;
                pairs[2 * found + 1] = static_cast<std::int32_t>(j);
                layers[found] = static_cast<std::int32_t>(layer);
            }
            ++found;
        };
        if (inverse_mass[i] > 0)
            for_each_wall(box, [&](int wall) {
                if (wall_distance(box, xi, wall) - radius[i] <= range) add(-1 - wall);
            });
        const std::int64_t first = found;
        for_each_near(cells, xi, 1, [&](std::int32_t j) {
            const std::int64_t other = ranks.layer(x + 3L * j);
            const bool is_seam = last > 1 && (other - layer == last || layer - other == last);
            if (j == i || is_seam == (ranks.rank[j] > r) || inverse_mass[i] + inverse_mass[j] == 0) return;
            if (sphere_gap(box, xi, x + 3L * j, radius[i], radius[j]) <= range) add(j);
        });
        if (found > capacity) continue;
        std::int32_t* mine = pairs + 2 * first;
        const std::int64_t count = found - first;
        for (std::int64_t a = 1; a < count; ++a) {  // few a body: sorted by insertion
            const std::int32_t j = mine[2 * a + 1];
            std::int64_t at = a;
            for (; at > 0 && ranks.rank[mine[2 * at - 1]] > ranks.rank[j]; --at)
                mine[2 * at + 1] = mine[2 * at - 1];
            mine[2 * at + 1] = j;
        }
        for (std::int64_t a = 0; a < count; ++a)
            if (mine[2 * a] > mine[2 * a + 1]) std::swap(mine[2 * a], mine[2 * a + 1]);
    }
    return found;
}

// How far a body has moved at most since it was at `old`.
inline double displacement(const Box& box, const double* old, const double* x, std::int64_t bodies) {
    double most = 0;
    for (std::int64_t b = 0; b < bodies; ++b) {
        double r[3];
        nearest_image(box, old + 3 * b, x + 3 * b, r);
        const double square = dot(r, r);
        if (!(square <= most)) most = square;  // also what is no number
    }
    return std::sqrt(most);
}

// Of a list, what may meet in a step.
struct Selection {
    std::int64_t pairs, bodies, even_bands, bands, lost;
    double shortest;  // time scale
};

struct SelectionArrays {
    std::int32_t *rows, *local;    // (M,), (M, 2): of the list; bodies as rows of `active`, or walls
    std::int32_t *active, *place;  // (N,): bodies that have a pair, by rank; room
    std::int32_t* bands;           // (M, 2): from and to, even layers first
};

// Pairs of a list that are in `range`, in its order. Rows of those that are not but have a contact under way
// (`is_under_way`) stand at the end of `rows`, backwards.
template <class UnderWay>
Selection select_pairs(const Box& box, const double* x, const double* radius, std::int64_t bodies,
                       double range, const std::int32_t* order, const std::int32_t* pairs,
                       const std::int32_t* layers, const double* times, std::int64_t count,
                       UnderWay&& is_under_way, const SelectionArrays& out) {
    Selection s{0, 0, 0, 0, 0, std::numeric_limits<double>::infinity()};
    std::fill(out.place, out.place + bodies, -1);
    for (std::int64_t k = 0; k < count; ++k) {
        const std::int32_t i = pairs[2 * k], j = pairs[2 * k + 1];
        const double *xi = x + 3L * i, *xj = x + 3L * j;
        const double gap = j < 0 ? wall_distance(box, xi, -1 - j) - radius[i]
                                 : sphere_gap(box, xi, xj, radius[i], radius[j]);
        if (gap <= range) {
            out.rows[s.pairs++] = static_cast<std::int32_t>(k);
            s.shortest = std::min(s.shortest, times[k]);
            out.place[i] = 0;
            if (j >= 0) out.place[j] = 0;
        } else if (is_under_way(k)) {
            out.rows[count - ++s.lost] = static_cast<std::int32_t>(k);
        }
    }
    for (std::int64_t r = 0; r < bodies; ++r) {
        if (out.place[order[r]] < 0) continue;
        out.place[order[r]] = static_cast<std::int32_t>(s.bodies);
        out.active[s.bodies++] = order[r];
    }
    for (std::int64_t n = 0; n < s.pairs; ++n)
        for (int side = 0; side < 2; ++side) {
            const std::int32_t id = pairs[2L * out.rows[n] + side];
            out.local[2 * n + side] = id < 0 ? id : out.place[id];
        }
    for (int colour = 0; colour < 2; ++colour) {
        for (std::int64_t n = 0; n < s.pairs;) {
            std::int64_t to = n;
            while (to < s.pairs && layers[out.rows[to]] == layers[out.rows[n]]) ++to;
            if (layers[out.rows[n]] % 2 == colour) {
                out.bands[2 * s.bands] = static_cast<std::int32_t>(n);
                out.bands[2 * s.bands++ + 1] = static_cast<std::int32_t>(to);
            }
            n = to;
        }
        if (colour == 0) s.even_bands = s.bands;
    }
    return s;
}

}  // namespace rdpm::contacts
