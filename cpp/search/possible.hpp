// What can ever happen from a state on, by the delete relaxation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <vector>

#include "search/prepared_task.hpp"
#include "task/state.hpp"

namespace explicable {

// For each operator whether it can ever be executed, for each fact whether it can ever hold. What can't change, such as a way that is
// blocked, closes operators.
struct Possible {
    std::vector<char> operators, facts;
    std::size_t memory_bytes() const { return sizeof(*this) + operators.capacity() + facts.capacity(); }
};

Possible find_possible(const PreparedTask& prepared, const State& state);

// The same for many states: from most of them the same is possible as from one asked about before.
class KnownPossible {
public:
    explicit KnownPossible(const PreparedTask& prepared) : prepared_(prepared) {}

    struct Entry {
        std::int64_t number;  // the same for the same
        std::shared_ptr<const Possible> possible;
    };
    Entry find(const State& state);

private:
    static constexpr std::size_t most_bytes = std::size_t{1} << 24;
    static constexpr std::int64_t most_looked_at = 20'000;  // operators: what can be had again is mostly near

    struct Known {
        State state;  // the last of those asked about
        Entry entry;
    };

    const PreparedTask& prepared_;
    std::list<Known> known_;  // the last asked about first
    std::size_t bytes_ = 0;
    std::int64_t next_number_ = 0;

    bool is_alike(const Known& known, const State& state) const;
    bool regains(const State& state, const std::vector<FactId>& gained, const std::vector<FactId>& lost) const;
};

}  // namespace explicable
