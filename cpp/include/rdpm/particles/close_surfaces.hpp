// How near the markers of a body are to the surfaces of others.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace rdpm {

// What lies around the bodies: the box's solid sides, and the pairs of bodies whose surfaces are close (a
// negative second id is a side).
struct Surroundings {
    double size[3];
    bool is_periodic[3], is_solid[3];
    const std::int32_t* pairs;
    int n_pairs;
};

// Distance from each marker to the nearest surface of another body or side; negative inside it; infinite
// where no pair is given.
inline void distance_to_others(const Surroundings& around, int bodies, const std::int32_t* first,
                               const double* marker, const double* centre, const double* radius, int threads,
                               double* out) {
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
        std::fill(out + first[b], out + first[b + 1], std::numeric_limits<double>::infinity());
        for (int k = begin[b]; k < begin[b + 1]; ++k) {
            const std::int32_t other = partner[k];
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
                const double x = marker[3 * m] - c[0], y = marker[3 * m + 1] - c[1],
                             z = marker[3 * m + 2] - c[2];
                out[m] = std::min(out[m], std::sqrt(x * x + y * y + z * z) - radius[other]);
            }
        }
    }
}

}  // namespace rdpm
