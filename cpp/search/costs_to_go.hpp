// Exact costs-to-go in one task, each found by a search once and remembered with the whole way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "search/engine.hpp"
#include "task/packed_state.hpp"
#include "task/state_registry.hpp"

namespace explicable {

// Every state on an optimal way has its own optimal rest, so one search answers for all of them. Who is known to have a way keeps
// it: so whatever is known leads to the goal.
class CostsToGo {
public:
    // What lies between a state and a goal.
    struct Ahead {
        double cost;       // dead_end: there is no way
        OperatorId first;  // with which a best way begins; -1 at the goal, and where there is no way
    };

    // Where more than `most` is known, all is forgotten before more is learned.
    CostsToGo(const Task& task, const StatePacker& packer, std::size_t most)
        : task_(task), packer_(packer), most_(most), known_(packer.num_words() + 1), key_(packer.num_words() + 1) {}

    // Null where nothing is known; the answer holds until something is learned.
    const Ahead* find(const Word* state, const std::vector<FactId>& goal);
    void learn_way(const Word* state, const std::vector<FactId>& goal, const std::vector<OperatorId>& way);
    void learn_dead_end(const Word* state, const std::vector<FactId>& goal);

private:
    const Task& task_;
    const StatePacker& packer_;
    std::size_t most_;
    std::map<std::vector<FactId>, Word> goals_;  // by number
    StateRegistry known_;                        // states, each with the number of a goal
    std::vector<Ahead> ahead_;                   // by number in known_
    std::vector<Word> key_;

    const Word* key(const Word* state, const std::vector<FactId>& goal);
    void make_room();
    void keep(const Word* state, const std::vector<FactId>& goal, Ahead ahead);
};

}  // namespace explicable
