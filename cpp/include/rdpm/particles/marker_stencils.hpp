// Where the markers lie on the grid and the weights they have there, made once a step.
//
// Markers are ordered by the plane and the row they lie in, whatever body they belong to: the fields then
// stream through the cache, which matters more than arithmetic where bodies are many. A marker away from the
// sides is kept as the place of its nearest centre and its distance from it, and its weights are found again
// at each use: that is less than reading them; across a periodic side its points are wrapped. Beside the
// other sides the stencils are folded, and kept.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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

struct StencilSet {
    std::vector<InnerMarker> inner;  // by plane, by row
    std::vector<FoldedStencils> folded;
    std::vector<std::int32_t> first;  // markers first[b] to first[b + 1] belong to body b
    std::vector<std::int32_t> row;    // of each marker, counted through all planes; -1 if folded
    std::vector<std::int32_t> begin;  // of each such row in `inner`, and one more

    StencilSet(const Grid& g, const std::int32_t* of_body, int bodies)
        : first(of_body, of_body + bodies + 1), row(first.back()), begin(rows(g) + 2) {
        inner.reserve(row.size());
    }
    static std::size_t rows(const Grid& g) { return static_cast<std::size_t>(g.nz() + 2) * (g.ny() + 2); }
    int count() const { return static_cast<int>(row.size()); }
    int count_inner() const { return static_cast<int>(inner.size()); }
    // The first marker of plane k in `inner`.
    int begin_of(const Grid& g, int k) const { return begin[static_cast<std::size_t>(k) * (g.ny() + 2)]; }
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

// The nearest centre, wrapped into the box, and the marker's distance from it in cells.
inline Place locate(const Grid& g, const double* x, int* middle, double* from_centre) {
    Place place = Place::inside;
    for (int d = 0; d < 3; ++d) {
        const double at = x[d] / g.spacing[d];
        const int nearest = static_cast<int>(std::floor(at + 1.0)), n = g.cells[d];
        from_centre[d] = at + 0.5 - nearest;
        middle[d] = nearest;
        // The nearest face may be one before; one point further on is read, with weight zero.
        if (nearest >= 3 && nearest < n - 1) continue;
        if (g.boundary[d] != periodic) return Place::folded;
        place = Place::wrapped;
        middle[d] = ((nearest - 1) % n + n) % n + 1;
    }
    return place;
}

inline void fold(const Grid& g, const double* x, FoldedStencils& out) {
    for (int d = 0; d < 3; ++d) {
        out.centre_of[d] = stencil_along(g, d, x[d], d == 0 ? face_y : face_x);
        out.face_of[d] = stencil_along(g, d, x[d], d);
    }
}

// Order and stencils of all markers.
inline void place(const Grid& g, const double* position, StencilSet& set) {
    const int markers = set.count();
    const auto row = static_cast<std::int32_t>(g.row()), plane = static_cast<std::int32_t>(g.plane());
#pragma omp parallel for num_threads(g.threads) schedule(static) if (markers > 256)
    for (int m = 0; m < markers; ++m) {
        int middle[3] = {};
        double from_centre[3];
        const bool folded = locate(g, position + 3 * m, middle, from_centre) == Place::folded;
        set.row[m] = folded ? -1 : middle[2] * (g.ny() + 2) + middle[1];
    }

    // begin[r + 1] counts, then moves from the begin of row r to its end while the markers are put in.
    std::fill(set.begin.begin(), set.begin.end(), 0);
    std::size_t folded = 0;
    for (int m = 0; m < markers; ++m) ++(set.row[m] < 0 ? set.begin[0] : set.begin[set.row[m] + 2]);
    folded = set.begin[0];
    set.begin[0] = 0;
    for (std::size_t r = 2; r < set.begin.size(); ++r) set.begin[r] += set.begin[r - 1];
    set.inner.resize(markers - folded);
    set.folded.resize(folded);
    folded = 0;
    for (int m = 0; m < markers; ++m)
        if (set.row[m] < 0)
            set.folded[folded++].marker = m;
        else
            set.inner[set.begin[set.row[m] + 1]++].marker = m;

#pragma omp parallel num_threads(g.threads) if (markers > 256)
    {
#pragma omp for schedule(static) nowait
        for (std::size_t n = 0; n < set.inner.size(); ++n) {
            InnerMarker& s = set.inner[n];
            int middle[3] = {};
            const Place place = locate(g, position + 3 * s.marker, middle, s.from_centre);
            s.first = (middle[2] - 1) * plane + (middle[1] - 1) * row + middle[0] - 1;
            if (place == Place::wrapped) s.first = ~s.first;
        }
#pragma omp for schedule(static)
        for (std::size_t n = 0; n < set.folded.size(); ++n)
            fold(g, position + 3 * set.folded[n].marker, set.folded[n]);
    }
}

// The nine rows of 27 points of a component about a marker beside a periodic side.
struct WrappedPoints {
    std::ptrdiff_t row[3][3];  // offset of its first cell; [plane][row]
    int plane[3], x[3];
    bool is_whole;  // three neighbours in memory

    // `nearest`: the nearest centre.
    WrappedPoints(const Grid& g, const InnerMarker& m, const int* nearest, int component) {
        int y[3];
        int* index[3] = {x, y, plane};
        for (int d = 0; d < 3; ++d) {
            const int n = g.cells[d],
                      low = nearest[d] - 1 - (d == component && std::signbit(m.from_centre[d]));
            for (int a = 0; a < 3; ++a)
                index[d][a] = low + a < 1 ? low + a + n : low + a > n ? low + a - n : low + a;
        }
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b)
                row[c][b] = static_cast<std::ptrdiff_t>(plane[c] * g.plane() + y[b] * g.row());
        is_whole = x[2] == x[0] + 2;
    }
};

struct PointWeights {
    double x[3], y[3], z[3];

    PointWeights(const Weights& all, int component, int n) {
        double* out[3] = {x, y, z};
        for (int d = 0; d < 3; ++d) {
            const int at = Weights::most * (d == component ? 3 + d : d) + n;
            out[d][0] = all.low[at];
            out[d][1] = all.middle[at];
            out[d][2] = all.high[at];
        }
    }
};

inline void nearest_centre(const Grid& g, const InnerMarker& m, int* nearest) {
    const int first = ~m.first, row = static_cast<int>(g.row()), plane = static_cast<int>(g.plane());
    const int k = first / plane, j = (first - k * plane) / row;
    nearest[0] = first - k * plane - j * row + 1;
    nearest[1] = j + 1;
    nearest[2] = k + 1;
}

}  // namespace rdpm
