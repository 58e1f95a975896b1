// Marker exclusion near other surfaces: how near a body's markers are to the surfaces of others, and what
// volume is left to them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace rdpm {

// What lies around the bodies: the box's walls, and the pairs of bodies whose surfaces are close (a
// negative second id is a side).
struct Surroundings {
    double size[3];
    bool is_periodic[3], is_solid[3];
    const std::int32_t* pairs;
    int n_pairs;
};

// The share of its volume left to a marker so far from another surface: `least` up to `near`, all from `far`
// on; inside the other body less and less, and none `width` deep.
struct Exclusion {
    double near, far, least, width;

    double share(double distance) const {
        const double outside = std::clamp((distance - near) / (far - near), 0.0, 1.0);
        return (least + (1.0 - least) * outside) * std::clamp(1.0 + distance / width, 0.0, 1.0);
    }
};

// The distance from each marker of body b to the nearest surface of its partners or walls; negative inside
// it.
inline void distance_to_partners(const Surroundings& around, int b, const std::int32_t* partner, int partners,
                                 const std::int32_t* first, const double* marker, const double* centre,
                                 const double* radius, double* out) {
    std::fill(out + first[b], out + first[b + 1], std::numeric_limits<double>::infinity());
    for (int n = 0; n < partners; ++n) {
        const std::int32_t other = partner[n];
        if (other < 0) {
            const int side = -1 - other, d = side / 2;
            if (!around.is_solid[d]) continue;
            for (int m = first[b]; m < first[b + 1]; ++m) {
                const double x = marker[3 * m + d];
                out[m] = std::min(out[m], side % 2 ? around.size[d] - x : x);
            }
            continue;
        }
        // The image of the partner that is nearest to the body is nearest to its markers on that side.
        double c[3];
        for (int d = 0; d < 3; ++d) {
            c[d] = centre[3 * other + d];
            if (around.is_periodic[d])
                c[d] += around.size[d] * std::round((centre[3 * b + d] - c[d]) / around.size[d]);
        }
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double x = marker[3 * m] - c[0], y = marker[3 * m + 1] - c[1], z = marker[3 * m + 2] - c[2];
            out[m] = std::min(out[m], std::sqrt(x * x + y * y + z * z) - radius[other]);
        }
    }
}

// volume = full volume, less where a marker is close to another surface.
inline void exclude_markers(const Surroundings& around, const Exclusion& exclusion, int bodies,
                            const std::int32_t* first, const double* marker, const double* centre,
                            const double* radius, const double* full, int threads, double* volume) {
    // Partners of each body: pairs are stored once, needed both ways.
    std::vector<std::int32_t> begin(bodies + 1, 0), partner;
    const auto each_way = [&](auto&& visit) {
        for (int p = 0; p < around.n_pairs; ++p) {
            const std::int32_t i = around.pairs[2 * p], j = around.pairs[2 * p + 1];
            visit(i, j);
            if (j >= 0) visit(j, i);
        }
    };
    each_way([&](std::int32_t i, std::int32_t) { ++begin[i + 1]; });
    for (int b = 0; b < bodies; ++b) begin[b + 1] += begin[b];
    partner.resize(begin[bodies]);
    std::vector<std::int32_t> at(begin.begin(), begin.end() - 1);
    each_way([&](std::int32_t i, std::int32_t j) { partner[at[i]++] = j; });
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        if (begin[b] == begin[b + 1]) {
            std::copy(full + first[b], full + first[b + 1], volume + first[b]);
            continue;
        }
        distance_to_partners(around, b, partner.data() + begin[b], begin[b + 1] - begin[b], first, marker,
                             centre, radius, volume);
        for (int m = first[b]; m < first[b + 1]; ++m) volume[m] = full[m] * exclusion.share(volume[m]);
    }
}

}  // namespace rdpm
