// A path scorer whose judgements are made by a Python object; slow, but open to any labeller.
#pragma once

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/core_task.hpp"
#include "search/path_scorer.hpp"

namespace explicable {

// The object's methods are called with the interpreter lock held; contexts are any Python values:
//   root(state) -> context
//   extend(context, operator, before, after) -> context
//   score(context, state, relaxed_plan) -> (num_inexplicable, variance, num_steps)
//   closing_key(context) -> int from 0 to 2**64 - 1
//   charge(context) -> float, if there is such a method: what the path costs besides its operators; it never falls
// A context in a search is a number; the values live as long as the scorer.
class CallbackScorer : public PathScorer {
public:
    CallbackScorer(const CoreTask& task, nb::object callbacks)
        : task_(task), callbacks_(std::move(callbacks)), charges_(nb::hasattr(callbacks_, "charge")) {}
    CallbackScorer(const CallbackScorer&) = delete;

    bool fits(const Task& task) const override { return &task == &task_; }
    std::size_t context_size() const override { return sizeof(std::size_t); }

    void root(const State& state, std::byte* context) const override {
        const nb::gil_scoped_acquire gil;
        keep(callbacks_.attr("root")(to_bytes(state)), context);
    }
    void extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                std::byte* context) const override {
        const nb::gil_scoped_acquire gil;
        keep(callbacks_.attr("extend")(value_of(parent), step, to_bytes(before), to_bytes(after)), context);
    }
    PathScore score(const std::byte* context, const State& state,
                    std::span<const OperatorId> relaxed_plan) const override {
        const nb::gil_scoped_acquire gil;
        nb::list steps;
        for (const OperatorId step : relaxed_plan) steps.append(step);
        const nb::object answer = callbacks_.attr("score")(value_of(context), to_bytes(state), steps);
        const PathScore score{nb::cast<double>(answer[0]), nb::cast<double>(answer[1]), nb::cast<int>(answer[2])};
        if (!(score.num_inexplicable >= 0.0) || !std::isfinite(score.num_inexplicable)) {
            throw std::invalid_argument("a scorer's number of inexplicable steps is negative or not finite");
        }
        return score;
    }
    bool charges() const override { return charges_; }
    double charge(const std::byte* context) const override {
        if (!charges_) return 0.0;
        const nb::gil_scoped_acquire gil;
        const auto charge = nb::cast<double>(callbacks_.attr("charge")(value_of(context)));
        if (!(charge >= 0.0) || !std::isfinite(charge)) throw std::invalid_argument("a scorer's charge is negative or not finite");
        return charge;
    }
    std::uint64_t closing_key(const std::byte* context) const override {
        const nb::gil_scoped_acquire gil;
        return nb::cast<std::uint64_t>(callbacks_.attr("closing_key")(value_of(context)));
    }

private:
    const CoreTask& task_;
    nb::object callbacks_;
    bool charges_;
    mutable std::vector<nb::object> values_;  // touched with the interpreter lock held only

    void keep(nb::object value, std::byte* context) const {
        const std::size_t number = values_.size();
        values_.push_back(std::move(value));
        std::memcpy(context, &number, sizeof number);
    }
    const nb::object& value_of(const std::byte* context) const {
        std::size_t number = 0;
        std::memcpy(&number, context, sizeof number);
        return values_[number];
    }
    nb::bytes to_bytes(const State& state) const {
        std::vector<Word> words(task_.packer.num_words());
        task_.packer.pack(state, words.data());
        return nb::bytes(words.data(), words.size() * sizeof(Word));
    }
};

}  // namespace explicable
