// Where the markers lie on the grid and the weights they have there, made once a step.
//
// Markers are ordered by body, and within one by the plane they lie in: what a body's markers touch of
// the fields stays in the core's cache while they are worked on, and the next body's is fetched meanwhile. A
// marker away from the faces of the box is kept as the place of its nearest centre and its distance from it,
// and its weights are found again at each use: that is less than reading them; across a periodic face its
// points are wrapped. Beside walls the stencils are folded, and kept. In a slab a marker that touches planes
// of other slabs too is kept like one to be wrapped, and works on the planes of this slab alone.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rdpm/particles/delta.hpp"
#include "rdpm/particles/prefetch.hpp"

namespace rdpm {

// Stencils of a marker beside a side, for values at centres and on faces along each direction. Component c
// needs faces along c and centres elsewhere; at a side the sign depends on the component only through c == d.
struct FoldedStencils {
    Stencil centre_of[3], face_of[3];
    std::int32_t marker;
    const Stencil& along(int d, int component) const { return d == component ? face_of[d] : centre_of[d]; }
};

// `at`: offset of each component's first of 27 points; the nearest centre where points are wrapped.
struct InnerMarker {
    std::int32_t at[3], marker;
};

// The inner markers of one body: where they and those whose points are wrapped begin in `StencilSet::inner`,
// the box of their nearest centres, and the lines of the fields that they touch, in `StencilSet::line`.
struct BodyMarkers {
    std::int32_t id, begin, wrapped;
    CellBox box;
    std::int64_t first_line, last_line;
};

// From a nearest centre to the farthest point of its stencil, along a direction [cells].
constexpr int stencil_reach = 2;

// So few are worked on by one thread: a second would have to be woken, and fetch from the first one's cache.
constexpr int few_markers = 2048;

// Of so many inner markers weights are found at a time.
constexpr int most_weights = 16;

// So far from the box may markers be, where it is periodic.
constexpr int most_periods = 8;

// In place of the plane, of markers beside a side, and of those that touch no plane of a slab.
constexpr std::int32_t folded_marker = INT32_MIN, absent_marker = INT32_MIN + 1, wrapped_marker = INT32_MAX;

inline bool is_inner(std::int32_t plane) {
    return plane > absent_marker;
}

struct StencilSet {
    Grid grid;               // for which it was made
    bool is_placed = false;  // the stencils are those of positions that were given
    // Body after body from bottom to top, within a body by plane, wrapped ones last.
    std::vector<InnerMarker> inner;
    std::vector<double> from_centre[3];  // of each of these, -0.5 to 0.5 [cells]
    std::vector<FoldedStencils> folded;
    std::vector<std::int32_t> first;     // markers first[b] to first[b + 1] belong to body b
    std::vector<BodyMarkers> body;       // in that order, and one more, of which only `begin` counts
    std::vector<std::int32_t> line;      // by body, by plane
    std::vector<std::int32_t> in_plane;  // inner markers whose nearest centre is in a plane; wrapped apart
    std::vector<std::int32_t> plane;     // of each marker's nearest centre, or that it is folded or wrapped
    std::vector<std::vector<std::int32_t>> scratch;  // of each thread: where a body's planes begin

    StencilSet(const Grid& g, const std::int32_t* of_body, int bodies)
        : grid(within_offsets(g)),
          first(of_body, of_body + bodies + 1),
          body(bodies + 1),
          in_plane(g.nz() + 2),
          plane(first.back()),
          scratch(std::max(1, g.threads)) {
        for (int b = 0; b <= bodies; ++b) body[b].id = b;
        inner.reserve(plane.size());
        for (auto& distance : from_centre) distance.resize(plane.size() + most_weights);
    }
    static const Grid& within_offsets(const Grid& g) {
        if (g.field_size() > INT32_MAX)
            throw std::invalid_argument(
                "grid: a field of " + std::to_string(g.field_size()) + " values (cells " +
                std::to_string(g.nx()) + " x " + std::to_string(g.ny()) + " x " + std::to_string(g.nz()) +
                " and halo) is beyond the markers' 32-bit offsets, at most " + std::to_string(INT32_MAX));
        return g;
    }
    int bodies() const { return static_cast<int>(body.size()) - 1; }
    int count() const { return static_cast<int>(plane.size()); }
    int count_inner() const { return static_cast<int>(inner.size()); }
};

// Four neighbouring doubles at once; the fourth enters with weight zero.
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

// Weights of a few inner markers at a time: at centres, and on faces.
struct Weights {
    Four x[2][most_weights];
    double y[2][3][most_weights], z[2][3][most_weights];  // low, middle, high

    void find(const StencilSet& set, int begin) {
        double along_x[2][3][most_weights];
        find_along(set.from_centre[0].data() + begin, along_x);
        find_along(set.from_centre[1].data() + begin, y);
        find_along(set.from_centre[2].data() + begin, z);
        for (int at = 0; at < 2; ++at)
            for (int n = 0; n < most_weights; ++n)
                x[at][n] = Four{along_x[at][0][n], along_x[at][1][n], along_x[at][2][n], 0.0};
    }

    // Of the markers [first, last) from `begin` on: no weight where another slab has the plane.
    void leave_out_planes_of_others(const Grid& g, const StencilSet& set, int begin, int first, int last) {
        for (int n = first; n < last; ++n) {
            const int nearest = set.inner[begin + n].at[2];
            for (int at = 0; at < 2; ++at) {
                const int lowest = nearest - (at == 1 && std::signbit(set.from_centre[2][begin + n]) ? 2 : 1);
                for (int c = 0; c < 3; ++c)
                    if (lowest + c < 1 || lowest + c > g.nz()) z[at][c][n] = 0.0;
            }
        }
    }

  private:
    static void find_along(const double* from_centre, double (*out)[3][most_weights]) {
#pragma omp simd
        for (int n = 0; n < most_weights; ++n) {
            const double r = from_centre[n];
            weigh(r, out[0], n);
            weigh(r - std::copysign(0.5, r), out[1], n);
        }
    }
    static void weigh(double r, double (*out)[most_weights], int n) {
        const double m = (1.0 + std::sqrt(1.0 - 3.0 * r * r)) * (1.0 / 3.0);
        out[0][n] = 0.5 * (1.0 - m - r);
        out[1][n] = m;
        out[2][n] = 0.5 * (1.0 - m + r);
    }
};

enum class Place { inside, wrapped, folded, absent };

// Where a marker is in a slab; its nearest plane becomes one of the slab's, of the image that is nearest to
// it.
inline Place locate_in_slab(const Grid& g, Place in_box, int& plane, bool is_face_below) {
    const int n = g.nz(), whole = g.box_planes;
    if (plane < -most_periods * whole || plane > most_periods * whole) return in_box;  // refused later
    plane = g.plane_here(plane);
    if (g.boundary[2] == periodic) {
        while (2 * plane < n + 1 - whole) plane += whole;
        while (2 * plane > n + 1 + whole) plane -= whole;
    }
    // Folding mirrors at most two planes beyond a wall.
    const int margin = in_box == Place::folded ? 2 : 0;
    const int lowest = plane - (is_face_below ? 2 : 1), highest = plane + 1;
    if (highest + margin < 1 || lowest - margin > n) return Place::absent;
    if (in_box == Place::folded || (lowest >= 1 && highest <= n)) return in_box;
    return Place::wrapped;
}

// The nearest centre and the marker's distance from it in cells. The nearest face is one before where that is
// negative; one point further on along x is read, with weight zero.
inline Place locate(const Grid& g, const double* cells_a_metre, const double* x, int* nearest,
                    double* from_centre) {
    Place place = Place::inside;
    for (int d = 0; d < 3; ++d) {
        const double at = x[d] * cells_a_metre[d];
        nearest[d] = static_cast<int>(std::floor(at + 1.0));
        from_centre[d] = at + 0.5 - nearest[d];
        if (g.boundary[d] != periodic) {
            if (nearest[d] < 3 || nearest[d] >= g.whole(d) - 1) {
                if (!g.is_slab()) return Place::folded;
                place = Place::folded;
            }
        } else if (place == Place::inside &&
                   (nearest[d] < (std::signbit(from_centre[d]) ? 3 : 2) || nearest[d] >= g.whole(d))) {
            place = Place::wrapped;
        }
    }
    return g.is_slab() ? locate_in_slab(g, place, nearest[2], std::signbit(from_centre[2])) : place;
}

inline void fold(const Grid& g, const double* x, FoldedStencils& out) {
    for (int d = 0; d < 3; ++d) {
        out.centre_of[d] = stencil_along(g, d, x[d], d == 0 ? face_y : face_x);
        out.face_of[d] = stencil_along(g, d, x[d], d);
    }
    if (!g.is_slab()) return;
    // What moving walls add is added once: by the slab of the nearest centre.
    int plane = static_cast<int>(std::floor(x[2] / g.spacing[2])) + 1;
    if (g.boundary[2] == periodic) plane = ((plane - 1) % g.box_planes + g.box_planes) % g.box_planes + 1;
    plane = g.plane_here(std::clamp(plane, 1, g.box_planes));
    if (plane >= 1 && plane <= g.nz()) return;
    for (int d = 0; d < 3; ++d)
        for (int side = 0; side < 2; ++side) out.centre_of[d].wall[side] = out.face_of[d].wall[side] = 0.0;
}

// Finds the box of one body's inner markers and how many there are.
inline void measure_body(const Grid& g, const double* position, StencilSet& set, int b) {
    BodyMarkers& body = set.body[b];
    const double cells_a_metre[3] = {1.0 / g.spacing[0], 1.0 / g.spacing[1], 1.0 / g.spacing[2]};
    body.begin = 0;  // counts
    for (int d = 0; d < 3; ++d) body.box.lower[d] = INT32_MAX, body.box.upper[d] = INT32_MIN;
    for (int m = set.first[body.id]; m < set.first[body.id + 1]; ++m) {
        int nearest[3] = {};
        double from_centre[3] = {};
        const Place place = locate(g, cells_a_metre, position + 3 * m, nearest, from_centre);
        set.plane[m] = place == Place::folded    ? folded_marker
                       : place == Place::absent  ? absent_marker
                       : place == Place::wrapped ? wrapped_marker
                                                 : nearest[2];
        if (!is_inner(set.plane[m])) continue;
        ++body.begin;
        for (int d = 0; d < 3; ++d) {
            body.box.lower[d] = std::min(body.box.lower[d], nearest[d]);
            body.box.upper[d] = std::max(body.box.upper[d], nearest[d]);
        }
    }
    if (body.begin == 0) body.box = {};
}

// Puts one body's inner markers into their order, and finds what they touch.
inline void order_body(const Grid& g, const double* position, StencilSet& set, int b,
                       std::vector<std::int32_t>& begin) {
    BodyMarkers& body = set.body[b];
    if (body.begin == set.body[b + 1].begin) return;
    body.last_line += find_lines(g, body.box, stencil_reach, set.line.data() + body.first_line);
    const double cells_a_metre[3] = {1.0 / g.spacing[0], 1.0 / g.spacing[1], 1.0 / g.spacing[2]};
    const int planes = body.box.upper[2] - body.box.lower[2] + 1;
    const auto row = static_cast<std::int32_t>(g.row()), plane = static_cast<std::int32_t>(g.plane());
    const auto wrapped = [&](int d, int i) {
        return g.wraps(d) ? ((i - 1) % g.cells[d] + g.cells[d]) % g.cells[d] + 1 : i;
    };
    const auto bucket = [&](int m) {
        return set.plane[m] == wrapped_marker ? planes : set.plane[m] - body.box.lower[2];
    };
    // begin[k + 1] counts, then moves from the begin of plane k to its end while the markers are put in.
    begin.assign(planes + 3, 0);
    for (int m = set.first[body.id]; m < set.first[body.id + 1]; ++m)
        if (is_inner(set.plane[m])) ++begin[bucket(m) + 2];
    for (int k = 0; k < planes; ++k) {
        if (begin[k + 2] > 0) {
            std::int32_t& total = set.in_plane[body.box.lower[2] + k];
#pragma omp atomic
            total += begin[k + 2];
        }
        begin[k + 2] += begin[k + 1];
    }
    body.wrapped = body.begin + begin[planes + 1];
    for (int m = set.first[body.id]; m < set.first[body.id + 1]; ++m) {
        if (!is_inner(set.plane[m])) continue;
        const std::int32_t at = body.begin + begin[bucket(m) + 1]++;
        int nearest[3] = {};
        double from_centre[3] = {};
        locate(g, cells_a_metre, position + 3 * m, nearest, from_centre);
        // Across a periodic face, where it is not used, it may be beyond 32 bits.
        const std::int64_t first =
            (nearest[2] - 1) * std::int64_t{plane} + (nearest[1] - 1) * std::int64_t{row} + nearest[0] - 1;
        const std::int32_t stride[3] = {1, row, plane};
        InnerMarker& s = set.inner[at];
        s.marker = m;
        for (int d = 0; d < 3; ++d) {
            set.from_centre[d][at] = from_centre[d];
            // Below the nearest centre the nearest face is one before.
            s.at[d] = set.plane[m] == wrapped_marker
                          ? wrapped(d, nearest[d])
                          : static_cast<std::int32_t>(first - (std::signbit(from_centre[d]) ? stride[d] : 0));
        }
    }
}

// Order and stencils of all markers.
inline void place(const Grid& g, const double* position, StencilSet& set) {
    const int bodies = set.bodies(), threads = std::min<int>(g.threads, set.scratch.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) measure_body(g, position, set, b);

    set.is_placed = false;
    for (int b = 0; b < bodies; ++b)
        for (int d = 0; d < 3; ++d)
            if (set.body[b].box.lower[d] < -most_periods * g.whole(d) ||
                set.body[b].box.upper[d] > most_periods * g.whole(d))
                throw std::invalid_argument("position: a marker of body " + std::to_string(set.body[b].id) +
                                            " is not finite, or more than eight periods from the box");

    // A thread then works on bodies that lie together.
    std::sort(set.body.begin(), set.body.end() - 1, [](const BodyMarkers& a, const BodyMarkers& b) {
        return std::pair(a.box.lower[2], a.id) < std::pair(b.box.lower[2], b.id);
    });
    set.body[bodies].begin = 0;
    std::int32_t inner = 0;
    std::int64_t lines = 0, room = 0;
    for (BodyMarkers& body : set.body) {
        body.first_line = body.last_line = lines;
        if (body.begin > 0) {
            lines += body.box.most_lines(stencil_reach);
            room += body.box.most_lines(stencil_reach + 1);  // a body moves, and its box grows by a cell
        }
        inner += std::exchange(body.begin, inner);
    }
    if (static_cast<std::int64_t>(set.line.size()) < lines) set.line.resize(room);
    set.inner.resize(inner);
    const auto absent = g.is_slab() ? std::count(set.plane.begin(), set.plane.end(), absent_marker) : 0;
    set.folded.resize(set.count() - inner - absent);
    if (!set.folded.empty())
        for (int m = 0, n = 0; m < set.count(); ++m)
            if (set.plane[m] == folded_marker) {
                set.folded[n].marker = m;
                fold(g, position + 3 * m, set.folded[n++]);
            }

    std::fill(set.in_plane.begin(), set.in_plane.end(), 0);
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) order_body(g, position, set, b, set.scratch[omp_get_thread_num()]);
    set.is_placed = true;
}

// Where the points about a marker beside a periodic face are: offsets of four planes, rows and columns in a
// line, the third of each being that of the nearest centre.
struct WrappedPoints {
    std::ptrdiff_t x[4], y[4], z[4];
    int plane[4];
    bool is_below[3];  // the nearest face is one before the nearest centre

    WrappedPoints(const Grid& g, const StencilSet& set, int inner) {
        const std::int32_t* nearest = set.inner[inner].at;
        const auto wrapped = [&](int d, int i) {
            if (!g.wraps(d)) return i;
            return i < 1 ? i + g.cells[d] : i > g.cells[d] ? i - g.cells[d] : i;
        };
        for (int a = 0; a < 4; ++a) {
            x[a] = wrapped(0, nearest[0] - 2 + a);
            y[a] = wrapped(1, nearest[1] - 2 + a) * static_cast<std::ptrdiff_t>(g.row());
            plane[a] = wrapped(2, nearest[2] - 2 + a);
            z[a] = (g.is_slab() ? std::clamp(plane[a], 1, g.nz()) : plane[a]) *
                   static_cast<std::ptrdiff_t>(g.plane());
        }
        for (int d = 0; d < 3; ++d) is_below[d] = std::signbit(set.from_centre[d][inner]);
    }
    // The first of a component's three points along a direction.
    template <int component>
    int begin(int d) const {
        return d == component && is_below[d] ? 0 : 1;
    }
};

}  // namespace rdpm
