// The smallest path scorer: each operator has a fixed weight of inexplicability, and weights add up.
#pragma once

#include <cstring>
#include <utility>
#include <vector>

#include "search/path_scorer.hpp"

namespace explicable {

class CountingScorer : public PathScorer {
public:
    explicit CountingScorer(std::vector<double> weights) : weights_(std::move(weights)) {}

    bool fits(const Task& task) const override {
        return weights_.size() == static_cast<std::size_t>(task.num_operators());
    }
    std::size_t context_size() const override { return sizeof(Context); }
    void root(const State&, std::byte* context) const override { write({0.0, 0}, context); }
    void extend(const std::byte* parent, OperatorId step, const State&, const State&, std::byte* context) const override {
        const Context before = read(parent);
        write({before.count + weights_[step], before.num_steps + 1}, context);
    }
    PathScore score(const std::byte* context, const State&, std::span<const OperatorId> relaxed_plan) const override {
        Context path = read(context);
        for (const OperatorId step : relaxed_plan) path.count += weights_[step];
        return {path.count, 0.0, static_cast<int>(path.num_steps + static_cast<std::int64_t>(relaxed_plan.size()))};
    }
    std::uint64_t closing_key(const std::byte*) const override { return 0; }
    bool has_bounds() const override { return true; }
    double least_count(const std::byte* context) const override { return read(context).count; }
    double least_growth(const std::byte*, OperatorId step, const std::byte*) const override { return weights_[step]; }

private:
    struct Context {
        double count;
        std::int64_t num_steps;
    };
    std::vector<double> weights_;

    static Context read(const std::byte* bytes) {
        Context context;
        std::memcpy(&context, bytes, sizeof context);
        return context;
    }
    static void write(const Context& context, std::byte* bytes) { std::memcpy(bytes, &context, sizeof context); }
};

}  // namespace explicable
