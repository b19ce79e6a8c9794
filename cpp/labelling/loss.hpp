// Negative log-likelihood of labelled sequences under a linear-chain conditional random field, and its gradient.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "labelling/chain.hpp"

namespace explicable {

// Features of many positions: row r holds (features[k], values[k]) for offsets[r] <= k < offsets[r + 1].
// Empty `values`: all are 1.
struct FeatureRows {
    std::vector<std::int64_t> offsets;
    std::vector<std::int32_t> features;
    std::vector<double> values;

    std::size_t size() const { return offsets.size() - 1; }
};

// Throws std::invalid_argument unless offsets are sorted and in range, features below num_features, values finite.
void check_rows(const FeatureRows& rows, std::int64_t num_features);

// state[r][j] = sum_k value * weights[feature][j]; `weights` is num_features x num_labels, `state` rows x num_labels.
void state_scores(const FeatureRows& rows, int num_labels, std::span<const double> weights, std::span<double> state);

// Labelled sequences, stored so that what positions share is computed once: a position is the number of its feature
// row. A label of kAnyLabel is unobserved and summed over. Labels may be given: known beforehand, wherever labels are predicted,
// so that nothing is to be learnt from their being what they are.
class SequenceLoss {
public:
    // Throws std::invalid_argument if sizes, offsets, row numbers or labels do not fit together.
    SequenceLoss(int num_labels, std::int64_t num_features, FeatureRows rows, std::vector<std::int64_t> offsets,
                 std::vector<std::int32_t> position_rows, std::vector<LabelId> position_labels,
                 std::vector<LabelId> position_given = {});

    std::size_t num_sequences() const { return offsets_.size() - 1; }
    // State weights (num_features x num_labels), then transition weights (num_labels x num_labels).
    std::size_t num_weights() const;

    // Returns sum_s sequence_weights[s] * -log p(labels_s | x_s, given_s) and writes its gradient by the weights.
    double operator()(std::span<const double> weights, std::span<const double> sequence_weights,
                      std::span<double> gradient) const;

private:
    double scaled(std::span<const double> state, std::span<const double> transition,
                  std::span<const double> sequence_weights, std::span<double> state_gradient,
                  std::span<double> transition_gradient) const;
    double in_log_space(std::span<const double> state, std::span<const double> transition,
                        std::span<const double> sequence_weights, std::span<double> state_gradient,
                        std::span<double> transition_gradient) const;
    double add_observed(std::size_t sequence, std::span<const double> state, std::span<const double> transition,
                        double weight, std::span<double> state_gradient,
                        std::span<double> transition_gradient) const;

    int num_labels_;
    std::int64_t num_features_;
    FeatureRows rows_;
    std::vector<std::int64_t> offsets_;
    std::vector<std::int32_t> position_rows_;
    std::vector<LabelId> position_labels_;
    std::vector<LabelId> position_given_;  // kAnyLabel where nothing is; empty if nowhere
    std::vector<bool> fully_observed_;  // per sequence
};

}  // namespace explicable
