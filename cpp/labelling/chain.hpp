// Inference in a linear-chain conditional random field, one sequence at a time, in log space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace explicable {

using LabelId = std::int32_t;
inline constexpr LabelId kAnyLabel = -1;  // a position that is not clamped: every label may stand there

// score(y) = sum_t state[t][y_t] + transition[y_{t-1}][y_t], over the labellings that agree with `clamped`.
// Scores pass are_usable_scores; labels in `clamped` are below num_labels.
struct Chain {
    int num_labels;
    std::span<const double> state;       // num_positions x num_labels
    std::span<const double> transition;  // num_labels (before) x num_labels (after)
    std::span<const LabelId> clamped;    // one a position, or empty: nothing is clamped

    std::size_t num_positions() const { return state.size() / static_cast<std::size_t>(num_labels); }
    bool allows(std::size_t position, int label) const {
        return clamped.empty() || clamped[position] == kAnyLabel || clamped[position] == label;
    }
};

// Finite, and so small that the score of no path overflows.
bool are_usable_scores(std::span<const double> scores);

// Most probable labelling. Ties go to the lowest label, here and at every predecessor, as in CRFsuite.
void viterbi(const Chain& chain, std::span<LabelId> labels);

// Writes p(y_t | x) into `marginals` (num_positions x num_labels) and returns the log partition function.
// With a non-empty `pair_counts` (num_labels x num_labels), sum_t p(y_{t-1}, y_t | x) is added to it.
double marginals(const Chain& chain, std::span<double> marginals, std::span<double> pair_counts = {});

// Distribution of the number of counted positions whose label is not `empty`: entry k is the probability of k.
// Every position counts if `counted` is empty. The result has one entry more than there are counted positions.
std::vector<double> count_distribution(const Chain& chain, LabelId empty, std::span<const std::uint8_t> counted);

}  // namespace explicable
