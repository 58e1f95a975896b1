// Squeeze film between two surfaces: the part of the normal resistance that the grid does not see.
#pragma once
#include <algorithm>
#include <cmath>

namespace rdpm::contacts {

// lambda(gap) - lambda(seen) with lambda = inverse/gap + log*ln(1/gap) [N s/m]; zero beyond gap_cut. The grid
// sees touching surfaces gap_touching apart and, linearly in between, those at gap_cut where they are. Held
// below gap_floor (the roughness); zero in overlap, where the solids carry the load and the film keeps its
// thickness: a soft contact's overlap is no film's flow, and would lose all of a rebound in it.
struct Film {
    double inverse, log, gap_floor, gap_cut, gap_touching;

    double seen(double gap) const { return gap_touching + gap * (1 - gap_touching / gap_cut); }

    double resistance(double gap) const {
        const double g = std::max(gap, gap_floor);
        if (gap <= 0 || !(g < gap_cut)) return 0;
        return inverse * (1 / g - 1 / seen(g)) + log * std::log(seen(g) / g);
    }

    // Mean over a path of gaps: the impulse of a film that is crossed in few sub-steps does not depend on
    // where these fall.
    double mean_resistance(double gap, double half_path) const {
        const double low = gap - std::abs(half_path), high = gap + std::abs(half_path);
        if (high <= 0 || low >= gap_cut || gap_floor >= gap_cut) return 0;
        const double length = high - low;
        if (length < 1e-3 * gap) return resistance(gap);
        const double from = std::clamp(low, gap_floor, gap_cut), to = std::clamp(high, gap_floor, gap_cut);
        const double held = std::min(high, gap_floor) - std::max(low, 0.0);
        double impulse = held > 0 ? held * resistance(gap_floor) : 0;
        const double middle = 0.5 * (from + to), slope = 1 - gap_touching / gap_cut;
        const double seen_part =
            slope > 1e-6 ? std::log(seen(to) / seen(from)) / slope : (to - from) / seen(middle);
        impulse += inverse * (std::log(to / from) - seen_part);
        impulse += log * (to - from) * std::log(seen(middle) / middle);
        return impulse / length;
    }
};

}  // namespace rdpm::contacts
