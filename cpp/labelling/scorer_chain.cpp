// What a scorer keeps of the labels of a path: the forward pass and Viterbi's, one step at a time.
#include <cmath>

#include "labelling/scorer.hpp"

namespace explicable {

void Scorer::append(Chain& chain, double score) const {
    if (expected_)
        append_expected(chain, score);
    else
        append_best(chain, score);
    chain.is_empty = false;
}

// Viterbi's step; ties go to "explicable", the first label.
void Scorer::append_best(Chain& chain, double score) const {
    std::array<double, 2> best{0, score};
    std::array<double, 2> count{0, 1};
    if (!chain.is_empty) {
        for (std::size_t j = 0; j < 2; ++j) {
            const double from_explicable = transitions_[0][j], from_other = chain.odds + transitions_[1][j];
            const auto before = static_cast<std::size_t>(from_other > from_explicable);
            best[j] += before == 0 ? from_explicable : from_other;
            count[j] += chain.count[before];
        }
    }
    chain.odds = best[1] - best[0];
    chain.count = {count[0], score == kExplicable ? count[0] : count[1]};
}

// The forward pass, with mean and variance of the number of inexplicable steps given the label of the last.
void Scorer::append_expected(Chain& chain, double score) const {
    std::array<double, 2> weight{1, 1};
    std::array<double, 2> mean{0, 1}, variance{0, 0};
    if (!chain.is_empty) {
        const std::array<double, 2> before{1 - chain.odds, chain.odds};
        for (std::size_t j = 0; j < 2; ++j) {
            const double other = before[1] * factors_[1][j];
            weight[j] = before[0] * factors_[0][j] + other;
            const double share = weight[j] > 0 ? other / weight[j] : 0;
            const double spread = chain.count[1] - chain.count[0];
            mean[j] += chain.count[0] + share * spread;
            variance[j] = chain.variance[0] + share * (chain.variance[1] - chain.variance[0]) +
                          share * (1 - share) * spread * spread;
        }
    }
    if (score == kExplicable) {
        chain.odds = 0;
        chain.count = {mean[0], mean[0]};
        chain.variance = {variance[0], variance[0]};
        return;
    }
    // The larger factor is 1, so that nothing overflows.
    weight[score > 0 ? 0 : 1] *= std::exp(-std::abs(score));
    chain.odds = weight[1] / (weight[0] + weight[1]);
    chain.count = mean;
    chain.variance = variance;
}

}  // namespace explicable
