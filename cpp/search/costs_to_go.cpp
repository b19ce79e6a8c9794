#include "search/costs_to_go.hpp"

#include <algorithm>
#include <iterator>

#include "task/successor.hpp"

namespace explicable {

const CostsToGo::Ahead* CostsToGo::find(const Word* state, const std::vector<FactId>& goal) {
    const StateId number = known_.find(key(state, goal));
    return number < 0 ? nullptr : &ahead_[number];
}

void CostsToGo::learn_way(const Word* state, const std::vector<FactId>& goal, const std::vector<OperatorId>& way) {
    make_room();
    const std::size_t num_words = packer_.num_words();
    std::vector<Word> states(state, state + num_words);  // along the way, one after the other
    for (const OperatorId step : way) {
        states.resize(states.size() + num_words);
        Word* after = states.data() + (states.size() - num_words);
        apply(task_, packer_, step, after - num_words, after);
    }
    double cost = 0.0;
    keep(states.data() + way.size() * num_words, goal, {cost, -1});
    for (std::size_t step = way.size(); step-- > 0;) {
        cost += task_.cost[way[step]];
        keep(states.data() + step * num_words, goal, {cost, way[step]});
    }
}

void CostsToGo::learn_dead_end(const Word* state, const std::vector<FactId>& goal) {
    make_room();
    keep(state, goal, {dead_end, -1});
}

const Word* CostsToGo::key(const Word* state, const std::vector<FactId>& goal) {
    std::copy_n(state, packer_.num_words(), key_.begin());
    key_.back() = goals_.try_emplace(goal, goals_.size()).first->second;
    return key_.data();
}

void CostsToGo::make_room() {
    if (ahead_.size() < most_) return;
    known_ = StateRegistry(packer_.num_words() + 1);
    ahead_.clear();
    goals_.clear();
}

void CostsToGo::keep(const Word* state, const std::vector<FactId>& goal, Ahead ahead) {
    if (known_.insert(key(state, goal)).second) ahead_.push_back(ahead);
}

}  // namespace explicable
