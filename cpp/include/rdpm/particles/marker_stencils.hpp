// Where the markers lie on the grid and the weights they have there, made once a step.
//
// Markers are ordered by body, and within one by the plane and the row they lie in: what a body's markers touch of
// the fields stays in the core's cache while they are worked on, and the next body's is fetched meanwhile. A marker
// away from the sides is kept as the place of its nearest centre and its distance from it, and its weights are found
// again at each use: that is less than reading them; across a periodic side its points are wrapped. Beside the other
// sides the stencils are folded, and kept.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "rdpm/particles/delta.hpp"

namespace rdpm {

// Stencils of a marker beside a side, for values at centres and on faces along each direction. Component c
// needs faces along c and centres elsewhere; at a side the sign depends on the component only through c == d.
struct FoldedStencils {
    Stencil centre_of[3], face_of[3];
    std::int32_t marker;
    const Stencil& along(int d, int component) const { return d == component ? face_of[d] : centre_of[d]; }
};

struct InnerMarker {
    double from_centre[3];  // [cells], -0.5 to 0.5
    std::int32_t first;     // offset of the first of the 27 centres; its complement where points are wrapped
    std::int32_t marker;
    bool is_wrapped() const { return first < 0; }
};

// The inner markers of one body: where they begin in `StencilSet::inner`, and the box of their nearest centres,
// unwrapped, in cells.
struct BodyMarkers {
    std::int32_t begin, lower[3], upper[3];
};

struct StencilSet {
    std::vector<InnerMarker> inner;  // body after body, within a body by plane and row
    std::vector<FoldedStencils> folded;
    std::vector<std::int32_t> first;                 // markers first[b] to first[b + 1] belong to body b
    std::vector<BodyMarkers> body;                   // and one more, of which only `begin` counts
    std::vector<std::int32_t> in_plane;              // inner markers whose nearest centre is in a plane
    std::vector<std::int32_t> row;                   // of each marker, within its body's box; -1 if folded
    std::vector<std::vector<std::int32_t>> scratch;  // of each thread: where a body's rows begin

    StencilSet(const Grid& g, const std::int32_t* of_body, int bodies)
        : first(of_body, of_body + bodies + 1),
          body(bodies + 1),
          in_plane(g.nz() + 2),
          row(first.back()),
          scratch(std::max(1, g.threads)) {
        inner.reserve(row.size());
    }
    int bodies() const { return static_cast<int>(body.size()) - 1; }
    int count() const { return static_cast<int>(row.size()); }
    int count_inner() const { return static_cast<int>(inner.size()); }
};

// Four neighbouring doubles at once; the fourth enters with weight zero.
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

// Weights of a few inner markers at a time: [direction][marker], at centres and, three further on, on faces.
struct Weights {
    static constexpr int most = 16;
    double low[6 * most], middle[6 * most], high[6 * most];

    void find(const InnerMarker* marker, int count) {
        double r[6 * most] = {};
        for (int n = 0; n < count; ++n)
            for (int d = 0; d < 3; ++d) {
                const double x = marker[n].from_centre[d];
                r[d * most + n] = x;
                r[(3 + d) * most + n] = x - std::copysign(0.5, x);
            }
#pragma omp simd
        for (int n = 0; n < 6 * most; ++n) {
            const double x = r[n], m = (1.0 + std::sqrt(1.0 - 3.0 * x * x)) * (1.0 / 3.0);
            middle[n] = m;
            low[n] = 0.5 * (1.0 - m - x);
            high[n] = 0.5 * (1.0 - m + x);
        }
    }
};

// Along one direction, of the component whose faces lie across `component`.
template <int component>
constexpr int weights_along(int direction) {
    return Weights::most * (direction == component ? 3 + direction : direction);
}

// The first of a marker's 27 points of a component: below the nearest centre the nearest face is one before.
template <int component>
inline std::ptrdiff_t first_point(const InnerMarker& m, std::size_t row, std::size_t plane) {
    const std::size_t stride = component == 0 ? 1 : component == 1 ? row : plane;
    return m.first - static_cast<std::ptrdiff_t>(
                         stride & -static_cast<std::size_t>(std::signbit(m.from_centre[component])));
}

enum class Place { inside, wrapped, folded };

// The nearest centre and the marker's distance from it in cells. The nearest face is one before where that is
// negative; one point further on along x is read, with weight zero.
inline Place locate(const Grid& g, const double* x, int* nearest, double* from_centre) {
    Place place = Place::inside;
    for (int d = 0; d < 3; ++d) {
        const double at = x[d] / g.spacing[d];
        nearest[d] = static_cast<int>(std::floor(at + 1.0));
        from_centre[d] = at + 0.5 - nearest[d];
        if (g.boundary[d] != periodic) {
            if (nearest[d] < 3 || nearest[d] >= g.cells[d] - 1) return Place::folded;
        } else if (nearest[d] < (std::signbit(from_centre[d]) ? 3 : 2) || nearest[d] >= g.cells[d]) {
            place = Place::wrapped;
        }
    }
    return place;
}

inline void fold(const Grid& g, const double* x, FoldedStencils& out) {
    for (int d = 0; d < 3; ++d) {
        out.centre_of[d] = stencil_along(g, d, x[d], d == 0 ? face_y : face_x);
        out.face_of[d] = stencil_along(g, d, x[d], d);
    }
}

// Finds the box of one body's inner markers and how many there are.
inline void measure_body(const Grid& g, const double* position, StencilSet& set, int b) {
    BodyMarkers& body = set.body[b];
    body.begin = 0;
    for (int d = 0; d < 3; ++d) body.lower[d] = INT32_MAX, body.upper[d] = INT32_MIN;
    for (int m = set.first[b]; m < set.first[b + 1]; ++m) {
        int nearest[3] = {};
        double from_centre[3];
        set.row[m] = locate(g, position + 3 * m, nearest, from_centre) == Place::folded ? -1 : 0;
        if (set.row[m] < 0) continue;
        ++body.begin;
        for (int d = 0; d < 3; ++d) {
            body.lower[d] = std::min(body.lower[d], nearest[d]);
            body.upper[d] = std::max(body.upper[d], nearest[d]);
        }
    }
}

// Puts one body's inner markers into their order.
inline void order_body(const Grid& g, const double* position, StencilSet& set, int b,
                       std::vector<std::int32_t>& begin) {
    const BodyMarkers& body = set.body[b];
    if (body.begin == set.body[b + 1].begin) return;
    const int rows = body.upper[1] - body.lower[1] + 1, planes = body.upper[2] - body.lower[2] + 1;
    const auto row = static_cast<std::int32_t>(g.row()), plane = static_cast<std::int32_t>(g.plane());
    const auto wrapped = [&](int d, int i) { return ((i - 1) % g.cells[d] + g.cells[d]) % g.cells[d] + 1; };
    // begin[r + 1] counts, then moves from the begin of row r to its end while the markers are put in.
    begin.assign(static_cast<std::size_t>(rows) * planes + 2, 0);
    for (int m = set.first[b]; m < set.first[b + 1]; ++m) {
        if (set.row[m] < 0) continue;
        int nearest[3] = {};
        double from_centre[3];
        locate(g, position + 3 * m, nearest, from_centre);
        set.row[m] = (nearest[2] - body.lower[2]) * rows + nearest[1] - body.lower[1];
        ++begin[set.row[m] + 2];
    }
    for (std::size_t r = 2; r < begin.size(); ++r) begin[r] += begin[r - 1];
    for (int k = 0; k < planes; ++k) {
        const std::int32_t count = begin[(k + 1) * rows + 1] - begin[k * rows + 1];
        std::int32_t& total = set.in_plane[wrapped(2, body.lower[2] + k)];
#pragma omp atomic
        total += count;
    }
    for (int m = set.first[b]; m < set.first[b + 1]; ++m) {
        if (set.row[m] < 0) continue;
        InnerMarker& s = set.inner[body.begin + begin[set.row[m] + 1]++];
        int nearest[3] = {};
        const Place place = locate(g, position + 3 * m, nearest, s.from_centre);
        if (place == Place::wrapped)
            for (int d = 0; d < 3; ++d) nearest[d] = wrapped(d, nearest[d]);
        s.first = (nearest[2] - 1) * plane + (nearest[1] - 1) * row + nearest[0] - 1;
        if (place == Place::wrapped) s.first = ~s.first;
        s.marker = m;
    }
}

// Order and stencils of all markers.
inline void place(const Grid& g, const double* position, StencilSet& set) {
    const int bodies = set.bodies(), threads = std::min<int>(g.threads, set.scratch.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) measure_body(g, position, set, b);

    set.body[bodies].begin = 0;
    std::int32_t inner = 0;
    for (BodyMarkers& body : set.body) inner += std::exchange(body.begin, inner);
    set.inner.resize(inner);
    set.folded.resize(set.count() - inner);
    if (!set.folded.empty())
        for (int m = 0, n = 0; m < set.count(); ++m)
            if (set.row[m] < 0) {
                set.folded[n].marker = m;
                fold(g, position + 3 * m, set.folded[n++]);
            }

    std::fill(set.in_plane.begin(), set.in_plane.end(), 0);
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) order_body(g, position, set, b, set.scratch[omp_get_thread_num()]);
}

// Where the points about a marker beside a periodic side are: offsets of four planes, rows and columns in a line,
// the third of each being that of the nearest centre.
struct WrappedPoints {
    std::ptrdiff_t x[4], y[4], z[4];
    int plane[4];
    bool is_below[3];  // the nearest face is one before the nearest centre

    WrappedPoints(const Grid& g, const InnerMarker& m) {
        const int first = ~m.first, row = static_cast<int>(g.row()), plane_size = static_cast<int>(g.plane());
        const int k = first / plane_size, j = (first - k * plane_size) / row;
        const int nearest[3] = {first - k * plane_size - j * row + 1, j + 1, k + 1};
        const auto wrapped = [&](int d, int i) { return i < 1 ? i + g.cells[d] : i > g.cells[d] ? i - g.cells[d] : i; };
        for (int a = 0; a < 4; ++a) {
            x[a] = wrapped(0, nearest[0] - 2 + a);
            y[a] = wrapped(1, nearest[1] - 2 + a) * static_cast<std::ptrdiff_t>(row);
            plane[a] = wrapped(2, nearest[2] - 2 + a);
            z[a] = plane[a] * static_cast<std::ptrdiff_t>(plane_size);
        }
        for (int d = 0; d < 3; ++d) is_below[d] = std::signbit(m.from_centre[d]);
    }
    // The first of a component's three points along a direction.
    template <int component>
    int begin(int d) const {
        return d == component && is_below[d] ? 0 : 1;
    }
};

}  // namespace rdpm
