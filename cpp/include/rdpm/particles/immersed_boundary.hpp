// Markers and grid: interpolation and spreading, exact adjoints.
//
// In spreading every thread adds only to the planes it owns, so no two threads touch a value and the order of
// a sum is fixed.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/particles/marker_stencils.hpp"

namespace rdpm {

// What moving walls add to the interpolated component: the folded weights times the walls' speed.
inline double wall_part(const Grid& g, const FoldedStencils& s, int component) {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d)
        if (d != component)
            for (int side = 0; side < 2; ++side)
                if (s.centre_of[d].wall[side] != 0.0)
                    sum += s.centre_of[d].wall[side] * g.velocity_of_face(2 * d + side, component);
    return sum;
}

inline double interpolate_folded(const Grid& g, const double* q, const FoldedStencils& s, int component) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        double in_plane = 0.0;
        const double* plane = q + z.index[c] * g.plane();
        for (int b = 0; b < 3; ++b) {
            const double* r = plane + y.index[b] * g.row();
            in_plane += y.weight[b] * (x.weight[0] * r[x.index[0]] + x.weight[1] * r[x.index[1]] +
                                       x.weight[2] * r[x.index[2]]);
        }
        sum += z.weight[c] * in_plane;
    }
    return sum + wall_part(g, s, component);
}

// Three neighbours along x of one row about a marker beside a periodic face.
inline Four load(const double* row, const std::ptrdiff_t* x, bool is_whole) {
    return is_whole ? *reinterpret_cast<const Four*>(row + x[0]) : Four{row[x[0]], row[x[1]], row[x[2]], 0.0};
}

template <int component>
inline Four interpolate_wrapped(const double* q, const WrappedPoints& at, const Weights& weights, int n) {
    const auto &in_y = weights.y[component == 1], &in_z = weights.z[component == 2];
    const std::ptrdiff_t *x = at.x + at.begin<component>(0), *y = at.y + at.begin<component>(1),
                         *z = at.z + at.begin<component>(2);
    const bool is_whole = x[2] == x[0] + 2;
    const auto in_plane = [&](const double* p) {
        return in_y[0][n] * load(p + y[0], x, is_whole) + in_y[1][n] * load(p + y[1], x, is_whole) +
               in_y[2][n] * load(p + y[2], x, is_whole);
    };
    return weights.x[component == 0][n] * (in_z[0][n] * in_plane(q + z[0]) + in_z[1][n] * in_plane(q + z[1]) +
                                           in_z[2][n] * in_plane(q + z[2]));
}

// Known at compile time which direction is on faces: the 27 terms unroll. What is left is to add up the four.
template <int component>
inline Four interpolate_inner(std::size_t row, std::size_t plane, const double* q, const InnerMarker& m,
                              const Weights& weights, int n) {
    const auto &in_y = weights.y[component == 1], &in_z = weights.z[component == 2];
    const double* p = q + m.at[component];
    const auto in_plane = [&](const double* r) {
        const auto at = [](const double* value) { return *reinterpret_cast<const Four*>(value); };
        return in_y[0][n] * at(r) + in_y[1][n] * at(r + row) + in_y[2][n] * at(r + 2 * row);
    };
    return weights.x[component == 0][n] * (in_z[0][n] * in_plane(p) + in_z[1][n] * in_plane(p + plane) +
                                           in_z[2][n] * in_plane(p + 2 * plane));
}

inline void add_up(const Four& u, const Four& v, const Four& w, double* out) {
    typedef std::int64_t Places __attribute__((vector_size(32)));
    const Four uv = __builtin_shuffle(u, v, Places{0, 4, 2, 6}) + __builtin_shuffle(u, v, Places{1, 5, 3, 7});
    out[0] = uv[0] + uv[2];
    out[1] = uv[1] + uv[3];
    out[2] = (w[0] + w[1]) + w[2];
}

// Has what body b's markers will touch, of the planes [first, last), fetched while so many others are worked
// on.
inline void aim(const Grid& g, const StencilSet& set, int b, int first, int last, int markers,
                Prefetch& ahead) {
    const BodyMarkers& body = set.body[b];
    auto begin = set.line.data() + body.first_line, end = set.line.data() + body.last_line;
    if (body.box.lower[2] > stencil_reach && body.box.upper[2] <= g.nz() - stencil_reach) {
        const auto plane = [&](int k) { return static_cast<std::int32_t>(k * g.plane()); };
        begin = std::lower_bound(begin, end, plane(first));
        end = std::lower_bound(begin, end, plane(last));
    }
    ahead.aim(begin, end, markers);
}

// The body to which an inner marker belongs.
inline int body_of(const StencilSet& set, int inner) {
    return static_cast<int>(std::upper_bound(set.body.begin(), set.body.end() - 1, inner,
                                             [](int n, const BodyMarkers& body) { return n < body.begin; }) -
                            set.body.begin()) -
           1;
}

// Velocity at the markers, (markers, 3); in a slab, what its planes add to it.
inline void interpolate(const Grid& g, const VelocityView& q, const StencilSet& set, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const std::size_t row = g.row(), plane = g.plane();
    const int inner = set.count_inner(), folded = static_cast<int>(set.folded.size());
    if (g.is_slab()) std::fill(out, out + 3 * static_cast<std::ptrdiff_t>(set.count()), 0.0);
#pragma omp parallel num_threads(g.threads) if (set.count() > few_markers)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        const int mine = static_cast<int>(static_cast<long>(inner) * me / team),
                  others = static_cast<int>(static_cast<long>(inner) * (me + 1) / team);
        Prefetch ahead(q);
        int b = body_of(set, mine) - 1;
        for (int begin = mine; begin < others;) {
            if (begin == mine || begin == set.body[b + 1].begin) {
                ++b;
                while (set.body[b + 1].begin <= begin) ++b;
                int after = b + 1;
                while (set.body[after].begin < others && set.body[after + 1].begin == set.body[after].begin)
                    ++after;
                if (set.body[after].begin < others) {
                    aim(g, set, after, 0, g.nz() + 2, set.body[b + 1].begin - begin, ahead);
                    const int id = set.body[after].id;
                    ahead.add(out + 3 * set.first[id], 3 * (set.first[id + 1] - set.first[id]));
                }
            }
            const InnerMarker* marker = set.inner.data() + begin;
            const int count = std::min({most_weights, others - begin, set.body[b + 1].begin - begin});
            Weights weights;
            weights.find(set, begin);
            const int inside = std::clamp(set.body[b].wrapped - begin, 0, count);
            for (int n = 0; n < inside; ++n) {
                ahead.advance();
                add_up(interpolate_inner<0>(row, plane, q.u, marker[n], weights, n),
                       interpolate_inner<1>(row, plane, q.v, marker[n], weights, n),
                       interpolate_inner<2>(row, plane, q.w, marker[n], weights, n),
                       out + 3 * marker[n].marker);
            }
            if (g.is_slab()) weights.leave_out_planes_of_others(g, set, begin, inside, count);
            for (int n = inside; n < count; ++n) {
                ahead.advance();
                const WrappedPoints at(g, set, begin + n);
                add_up(interpolate_wrapped<0>(q.u, at, weights, n),
                       interpolate_wrapped<1>(q.v, at, weights, n),
                       interpolate_wrapped<2>(q.w, at, weights, n), out + 3 * marker[n].marker);
            }
            begin += count;
        }
#pragma omp for schedule(static)
        for (int n = 0; n < folded; ++n)
            for (int c = 0; c < 3; ++c)
                out[3 * set.folded[n].marker + c] = interpolate_folded(g, field[c], set.folded[n], c);
    }
}

// One marker's share in the planes [first, last).
inline void spread_folded(const Grid& g, double* q, const FoldedStencils& s, int component, double strength,
                          int first, int last) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    for (int c = 0; c < 3; ++c) {
        if (z.index[c] < first || z.index[c] >= last) continue;
        for (int b = 0; b < 3; ++b) {
            double* r = q + z.index[c] * g.plane() + y.index[b] * g.row();
            const double f = strength * z.weight[c] * y.weight[b];
            for (int a = 0; a < 3; ++a) r[x.index[a]] += f * x.weight[a];
        }
    }
}

// What a marker away from the faces of the box gives; `bounded`: to the planes [first, last) only.
template <int component, bool bounded>
inline void spread_inner(std::size_t row, std::size_t plane, double* q, const InnerMarker& m,
                         const Weights& weights, int n, double strength, int first, int last) {
    const auto &in_y = weights.y[component == 1], &in_z = weights.z[component == 2];
    const Four along_x = strength * weights.x[component == 0][n];
    double* p = q + m.at[component];
    const int lowest = bounded ? m.at[component] / static_cast<int>(plane) : 0;
    const auto at = [](double* r) -> Four& { return *reinterpret_cast<Four*>(r); };
    // Read before anything is written, which may alias them.
    const double z[3] = {in_z[0][n], in_z[1][n], in_z[2][n]}, low = in_y[0][n], middle = in_y[1][n],
                 high = in_y[2][n];
    for (int c = 0; c < 3; ++c, p += plane) {
        if (bounded && (lowest + c < first || lowest + c >= last)) continue;
        const Four f = z[c] * along_x;
        at(p) += low * f;
        at(p + row) += middle * f;
        at(p + 2 * row) += high * f;
    }
}

// What a marker beside a periodic face gives to the planes [first, last).
template <int component>
inline void spread_wrapped(double* q, const WrappedPoints& at, const Weights& weights, int n, double strength,
                           int first, int last) {
    const auto &in_y = weights.y[component == 1], &in_z = weights.z[component == 2];
    const int lowest = at.begin<component>(2);
    const std::ptrdiff_t *x = at.x + at.begin<component>(0), *y = at.y + at.begin<component>(1);
    const bool is_whole = x[2] == x[0] + 2;
    const Four along_x = strength * weights.x[component == 0][n];
    const double in_plane[3] = {in_z[0][n], in_z[1][n], in_z[2][n]},
                 in_row[3] = {in_y[0][n], in_y[1][n], in_y[2][n]};
    for (int c = 0; c < 3; ++c) {
        if (at.plane[lowest + c] < first || at.plane[lowest + c] >= last) continue;
        double* p = q + at.z[lowest + c];
        const Four f = in_plane[c] * along_x;
        for (int b = 0; b < 3; ++b) {
            double* r = p + y[b];
            if (is_whole)
                *reinterpret_cast<Four*>(r + x[0]) += in_row[b] * f;
            else
                for (int a = 0; a < 3; ++a) r[x[a]] += in_row[b] * f[a];
        }
    }
}

struct Source {
    const double *value, *volume;  // (markers, 3), (markers)
    double factor;
};

// Inner markers of a body that follow each other: those from `wrapped` on are so.
struct Run {
    int begin, wrapped, end;
    int count() const { return end - begin; }
};

// Which markers give to the planes [first, last): those from two planes below that of its nearest centre to
// one above it are a marker's.
struct Reach {
    int first, last;
    // Of `InnerMarker::at[0]`: where the planes hold all that a marker gives, or some of it.
    long whole[2], part[2];

    Reach(const Grid& g, int first, int last) : first(first), last(last) {
        // The first point lies in the plane before that of the nearest centre.
        const auto offset = [&](int k) { return static_cast<long>(k - 1) * static_cast<long>(g.plane()); };
        whole[0] = offset(first + 2), whole[1] = offset(last - 1);
        part[0] = offset(first - 1), part[1] = offset(last + 2);
    }

    // Those of body b.
    Run run_of(const Grid& g, const StencilSet& set, int b) const {
        const BodyMarkers& body = set.body[b];
        const Run all{body.begin, body.wrapped, set.body[b + 1].begin}, none{};
        if (all.count() == 0) return none;
        const int lowest = body.box.lower[2] - 2, highest = body.box.upper[2] + 1, n = g.nz();
        if (lowest < 1 || highest > n) {
            if (g.is_slab()) return all;
            // Any number of periods outside the box.
            const int low = ((lowest - 1) % n + n) % n + 1, high = highest + (low - lowest);
            for (const int shift : {-n, 0, n})
                if (low + shift < last && high + shift >= first) return all;
            return none;
        }
        if (lowest >= last || highest < first) return none;
        if (all.wrapped < all.end || (lowest >= first && highest < last)) return all;
        // In the order of planes: those out of reach come first and last.
        const auto begin = set.inner.begin() + all.begin, end = set.inner.begin() + all.end;
        const auto before = [](long limit) {
            return [limit](const InnerMarker& m) { return m.at[0] < limit; };
        };
        const auto from = std::partition_point(begin, end, before(part[0])),
                   to = std::partition_point(from, end, before(part[1]));
        const int stop = static_cast<int>(to - set.inner.begin());
        return {static_cast<int>(from - set.inner.begin()), stop, stop};
    }
};

// What a run of inner markers gives to the planes [first, last).
inline void spread_run(const Grid& g, const VelocityArrays& q, const StencilSet& set, const Source& source,
                       Run run, const Reach& reach, Prefetch& ahead) {
    const std::size_t row = g.row(), plane = g.plane();
    const int first = reach.first, last = reach.last;
    for (int begin = run.begin; begin < run.end; begin += most_weights) {
        const InnerMarker* marker = set.inner.data() + begin;
        const int count = std::min(most_weights, run.end - begin),
                  inside = std::clamp(run.wrapped - begin, 0, count);
        Weights weights;
        weights.find(set, begin);
        for (int n = 0; n < inside; ++n) {
            ahead.advance();
            const InnerMarker& m = marker[n];
            const double *f = source.value + 3 * m.marker, strength = source.factor * source.volume[m.marker];
            if (m.at[0] >= reach.whole[0] && m.at[0] < reach.whole[1]) {
                spread_inner<0, false>(row, plane, q.u, m, weights, n, strength * f[0], 0, 0);
                spread_inner<1, false>(row, plane, q.v, m, weights, n, strength * f[1], 0, 0);
                spread_inner<2, false>(row, plane, q.w, m, weights, n, strength * f[2], 0, 0);
            } else if (m.at[0] >= reach.part[0] && m.at[0] < reach.part[1]) {
                spread_inner<0, true>(row, plane, q.u, m, weights, n, strength * f[0], first, last);
                spread_inner<1, true>(row, plane, q.v, m, weights, n, strength * f[1], first, last);
                spread_inner<2, true>(row, plane, q.w, m, weights, n, strength * f[2], first, last);
            }
        }
        for (int n = inside; n < count; ++n) {
            ahead.advance();
            const InnerMarker& m = marker[n];
            const double *f = source.value + 3 * m.marker, strength = source.factor * source.volume[m.marker];
            const WrappedPoints at(g, set, begin + n);
            spread_wrapped<0>(q.u, at, weights, n, strength * f[0], first, last);
            spread_wrapped<1>(q.v, at, weights, n, strength * f[1], first, last);
            spread_wrapped<2>(q.w, at, weights, n, strength * f[2], first, last);
        }
    }
}

// q += factor * sum over markers of value * volume * delta: the adjoint of interpolate.
inline void spread(const Grid& g, const VelocityArrays& q, const StencilSet& set, const double* value,
                   const double* volume, double factor) {
    double* field[3] = {q.u, q.v, q.w};
    const Source source{value, volume, factor / g.volume()};
    const int nz = g.nz(), bodies = set.bodies();
    const long inner = std::accumulate(set.in_plane.begin(), set.in_plane.end(), 0L);
    const int threads = set.count() > few_markers ? std::min(g.threads, nz) : 1;
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        // Equal numbers of markers, cut between planes.
        const auto cut = [&](int t) {
            if (t == 0) return 1;
            if (t == team) return nz + 1;
            int k = 1;
            for (long before = 0; k <= nz && before < inner * t / team; ++k) before += set.in_plane[k];
            return k;
        };
        const int first = cut(me), last = cut(me + 1);
        const Reach reach(g, first, last);
        int after = 0;  // the body to come
        const auto next_run = [&] {
            Run run{};
            while (after < bodies && (run = reach.run_of(g, set, after++)).count() == 0) {
            }
            return run;
        };
        Prefetch ahead(q);
        for (Run run = next_run(); run.count() > 0;) {
            const Run next = next_run();
            if (next.count() > 0) {
                const int id = set.body[after - 1].id, markers = set.first[id + 1] - set.first[id];
                aim(g, set, after - 1, first, last, run.count(), ahead);
                ahead.add(value + 3 * set.first[id], 3 * markers);
                ahead.add(volume + set.first[id], markers);
            }
            spread_run(g, q, set, source, run, reach, ahead);
            run = next;
        }
        for (const FoldedStencils& s : set.folded) {
            const double strength = source.factor * volume[s.marker];
            for (int c = 0; c < 3; ++c)
                spread_folded(g, field[c], s, c, strength * value[3 * s.marker + c], first, last);
        }
    }
}

}  // namespace rdpm
