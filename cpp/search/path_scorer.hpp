// What a search asks of a labeller: a context per node, extended step by step, and a score of path # relaxed plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "task/state.hpp"

namespace explicable {

// Of the steps of `path # relaxed plan`: how many are (expected to be) inexplicable, with variance.
struct PathScore {
    double num_inexplicable;
    double variance;
    int num_steps;
};

// Thread-safe: all methods are const and keep what they need in the contexts that the caller owns.
class PathScorer {
public:
    virtual ~PathScorer() = default;
    virtual std::size_t context_size() const = 0;  // bytes, the same for every node
    virtual void root(const State& state, std::byte* context) const = 0;
    // `before` is the state in which `step` is executed, `after` the state that it leads to.
    virtual void extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                        std::byte* context) const = 0;
    virtual PathScore score(const std::byte* context, const State& state,
                            std::span<const OperatorId> relaxed_plan) const = 0;
    // Equal keys: the two contexts score every continuation alike (up to a constant count).
    virtual std::uint64_t closing_key(const std::byte* context) const = 0;
};

}  // namespace explicable
