// What a search asks of a labeller: a context per node, extended step by step, and a score of path # relaxed plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "task/state.hpp"

namespace explicable {

// Of the steps of `path # relaxed plan`: how many are (expected to be) inexplicable, with variance.
struct PathScore {
    double num_inexplicable;
    double variance;
    int num_steps;
};

// Counts the inexplicable steps of one node's children, which need no contexts for that.
class ChildCounter {
public:
    virtual ~ChildCounter() = default;
    virtual void start(const std::byte* parent, const State& state) = 0;
    // `step` leads to the child, which has `state`.
    virtual double count(OperatorId step, const State& state, std::span<const OperatorId> relaxed_plan) = 0;
};

// Answers one search, which asks about one node after another; it may remember what it has been asked.
class Counter {
public:
    virtual ~Counter() = default;
    // The number of inexplicable steps alone, which is all that a search asks for.
    virtual double count(const std::byte* context, const State& state, std::span<const OperatorId> relaxed_plan) = 0;
    // None: the children are to be asked about as any other node.
    virtual ChildCounter* of_children() { return nullptr; }
};

// Thread-safe: all methods are const and keep what they need in the contexts that the caller owns.
class PathScorer {
public:
    virtual ~PathScorer() = default;
    virtual bool fits(const Task&) const { return true; }  // whether it is for this task
    virtual std::size_t context_size() const = 0;  // bytes, the same for every node
    virtual void root(const State& state, std::byte* context) const = 0;
    // `before` is the state in which `step` is executed, `after` the state that it leads to.
    virtual void extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                        std::byte* context) const = 0;
    virtual PathScore score(const std::byte* context, const State& state,
                            std::span<const OperatorId> relaxed_plan) const = 0;
    // It must not outlive the scorer. By default it asks for scores.
    virtual std::unique_ptr<Counter> counter() const;
    // Contexts with equal keys are comparable by `lead`.
    virtual std::uint64_t closing_key(const std::byte* context) const = 0;
    // At most so many more steps are inexplicable after `a` than after `b`, whatever follows both; infinite if not known.
    // Both contexts belong to `state` and have equal closing keys. By default all continuations score alike.
    virtual double lead(const std::byte* a, const std::byte* b, const State& state) const {
        return score(a, state, {}).num_inexplicable - score(b, state, {}).num_inexplicable;
    }

    // What a path costs besides its operators, in the unit of cost; it never falls along a path. Contexts with equal closing
    // keys, of one state, are charged alike for whatever follows.
    virtual double charge(const std::byte*) const { return 0.0; }
    virtual bool charges() const { return false; }  // whether any path is charged

    // Lower bounds. For every plan through a context, the number of inexplicable steps is at least `least_count` of it, and
    // `least_growth` of all further extensions, and `least_end` of the last context. All are 0 where nothing is known.
    virtual bool has_bounds() const { return false; }
    virtual double least_count(const std::byte*) const { return 0.0; }
    virtual double least_growth(const std::byte* /*parent*/, OperatorId /*step*/, const std::byte* /*child*/) const { return 0.0; }
    virtual double least_end(const std::byte*) const { return 0.0; }
    // Contexts with equal outlook keys have like bounds on what lies ahead. `widen` lets `context` stand for `other` too: from
    // then on `least_growth` and `least_end` of it, and of what extends it, are lower bounds for both.
    virtual std::uint64_t outlook_key(const std::byte*) const { return 0; }
    virtual void widen(std::byte* /*context*/, const std::byte* /*other*/) const {}
};

inline std::unique_ptr<Counter> PathScorer::counter() const {
    class OfScores : public Counter {
    public:
        explicit OfScores(const PathScorer& scorer) : scorer_(scorer) {}
        double count(const std::byte* context, const State& state, std::span<const OperatorId> relaxed_plan) override {
            return scorer_.score(context, state, relaxed_plan).num_inexplicable;
        }

    private:
        const PathScorer& scorer_;
    };
    return std::make_unique<OfScores>(*this);
}

}  // namespace explicable
