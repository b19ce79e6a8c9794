#include "labelling/telling.hpp"

#include <cstring>
#include <stdexcept>

namespace explicable {

Task with_telling(const Task& task, std::int32_t num_sets, const std::vector<Telling>& tellings) {
    if (num_sets < 1) throw std::invalid_argument("nothing told is a set too");
    Task result = task;
    const FactId first = task.num_facts();
    const VariableId told = task.num_variables();
    std::vector<FactId> facts;
    const std::vector<std::int32_t> none;
    for (std::int32_t set = 0; set < num_sets; ++set) {
        facts.push_back(first + set);
        result.fact_variable.push_back(told);
        result.fact_value.push_back(set + 1);
        result.fact_predicate.push_back(auxiliary);
        result.fact_arguments.push_back(none);
    }
    result.variable_facts.push_back(facts);
    result.initial.push_back(first);
    for (const Telling& telling : tellings) {
        const auto is_set = [num_sets](std::int32_t set) { return set >= 0 && set < num_sets; };
        if (!is_set(telling.from) || !is_set(telling.to) || telling.from == telling.to || telling.schema < 0)
            throw std::invalid_argument("a telling leads to no set");
        result.preconditions.push_back(std::vector<FactId>{first + telling.from});
        result.adds.push_back(std::vector<FactId>{first + telling.to});
        result.deletes.push_back(std::vector<FactId>{first + telling.from});
        result.cost.push_back(0);
        result.operator_schema.push_back(telling.schema);
        result.operator_arguments.push_back(none);
        result.effect_offsets.push_back(result.effect_offsets.back());
    }
    return result;
}

void TellingScorer::extend(const std::byte* parent, OperatorId step, const State& before, const State& after,
                           std::byte* context) const {
    if (step < first_telling_) return knowing(before).extend(parent, step, before, after, context);
    std::memcpy(context, parent, context_size());
    any().add_charge(context, price_);
}

std::unique_ptr<Counter> TellingScorer::counter() const {
    class OfSets : public Counter {
    public:
        explicit OfSets(const TellingScorer& scorer) : scorer_(scorer), counters_(scorer.scorers_.size()) {}
        double count(const std::byte* context, const State& state, std::span<const OperatorId> relaxed_plan) override {
            auto& counter = counters_[scorer_.set_told(state)];
            if (!counter) counter = scorer_.knowing(state).counter();
            return counter->count(context, state, relaxed_plan);
        }

    private:
        const TellingScorer& scorer_;
        std::vector<std::unique_ptr<Counter>> counters_;
    };
    return std::make_unique<OfSets>(*this);
}

}  // namespace explicable
