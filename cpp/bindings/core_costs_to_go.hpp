// What Python knows as _core.CostsToGo.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "bindings/questions.hpp"
#include "search/costs_to_go.hpp"
#include "task/successor.hpp"

namespace explicable {

// Costs-to-go for Python, from a state or from what an operator (`by`, if not -1) makes of it. Many short questions: what takes long
// is given up, since it can't be interrupted; the answer is then to be learned.
class CoreCostsToGo {
public:
    CoreCostsToGo(const CoreTask& task, std::size_t most) : task_(task), known_(task, task.packer, most) {}
    CoreCostsToGo(const CoreCostsToGo&) = delete;

    // None where a limit ended the search.
    nb::object cost(const nb::bytes& state, const std::vector<FactId>& goal, OperatorId by) {
        const CostsToGo::Ahead* ahead = look(start(state, by), goal);
        if (!ahead) return nb::none();
        return ahead->cost == dead_end ? nb::object(nb::float_(dead_end)) : nb::object(nb::int_(static_cast<std::int64_t>(ahead->cost)));
    }
    // The first operator of a best way; -1 at the goal, and where there is no way.
    std::optional<OperatorId> first(const nb::bytes& state, const std::vector<FactId>& goal, OperatorId by) {
        const CostsToGo::Ahead* ahead = look(start(state, by), goal);
        return ahead ? std::optional(ahead->first) : std::nullopt;
    }
    std::optional<std::vector<OperatorId>> way(const nb::bytes& state, const std::vector<FactId>& goal, OperatorId by) {
        std::vector<Word> words = start(state, by), next(words.size());
        std::vector<OperatorId> way;
        for (;;) {
            const CostsToGo::Ahead* ahead = look(words, goal);
            if (!ahead) return std::nullopt;
            if (ahead->first < 0) return way;
            way.push_back(ahead->first);
            apply(task_, task_.packer, ahead->first, words.data(), next.data());
            std::swap(words, next);
        }
    }
    // Nothing in the place of a way: there is none.
    void learn(const nb::bytes& state, const std::vector<FactId>& goal, const std::optional<std::vector<OperatorId>>& way) {
        check_goal(task_, goal);
        const std::vector<Word> from = start(state, -1);
        if (!way) return known_.learn_dead_end(from.data(), goal);
        std::vector<Word> words = from, next(words.size());
        for (const OperatorId step : *way) {
            check_operator(step);
            if (!task_.index.is_applicable(task_.packer, words.data(), step)) throw std::invalid_argument("not a way through this task");
            apply(task_, task_.packer, step, words.data(), next.data());
            std::swap(words, next);
        }
        known_.learn_way(from.data(), goal, *way);
    }

private:
    static constexpr std::int64_t most_evaluations = 10'000;  // a fraction of a second
    static constexpr std::size_t most_bytes = std::size_t{1} << 26;

    const CoreTask& task_;
    CostsToGo known_;

    void check_operator(OperatorId id) const {
        if (id < 0 || id >= task_.num_operators()) throw nb::index_error("no such operator");
    }
    std::vector<Word> start(const nb::bytes& bytes, OperatorId by) const {
        std::vector<Word> words(task_.packer.num_words()), after(words.size());
        task_.packer.pack(state_of(task_, bytes), words.data());
        if (by == -1) return words;
        check_operator(by);
        apply(task_, task_.packer, by, words.data(), after.data());
        return after;
    }
    const CostsToGo::Ahead* look(const std::vector<Word>& words, const std::vector<FactId>& goal) {
        check_goal(task_, goal);
        if (const auto* ahead = known_.find(words.data(), goal)) return ahead;
        if (task_.prepared.estimated_bytes() > most_bytes) return nullptr;
        const Question question(task_.prepared, task_.packer.unpack(words.data()), goal);
        auto answer = [&] {
            const nb::gil_scoped_release released;
            return task_.ways.find(question, {.memory_bytes = most_bytes, .evaluations = most_evaluations});
        }();
        if (!answer.is_known) return nullptr;
        if (answer.plan) {
            // What stands for a disjunctive goal is no step of the way.
            std::erase_if(*answer.plan, [&](OperatorId step) { return task_.operator_schema[step] == auxiliary; });
            known_.learn_way(words.data(), goal, *answer.plan);
        } else {
            known_.learn_dead_end(words.data(), goal);
        }
        return known_.find(words.data(), goal);
    }
};

}  // namespace explicable
