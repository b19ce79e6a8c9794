// Cheapest ways in one task, for those who ask for many, most of them short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "search/engine.hpp"
#include "search/tour.hpp"
#include "task/packed_state.hpp"

namespace explicable {

// Answers as A* with the tour heuristic does, plan for plan. What A* makes for each question is made once for all questions
// alike, and where the heuristic is exact A* only ever goes down, which takes no open list. Where it is not, the tighter bound mostly
// tells what lies on no best way. A* may leave that out: of what does, the one that would come first still does.
class WayFinder {
public:
    WayFinder(const PreparedTask& prepared, const StatePacker& packer) : prepared_(prepared), packer_(packer), possible_(prepared) {}

    struct Answer {
        bool is_known = false;  // else a limit ended the search
        std::optional<std::vector<OperatorId>> plan;
    };
    Answer find(const Question& question, const Limits& limits);

private:
    static constexpr std::size_t most_bytes = std::size_t{1} << 24;  // of tours kept

    const PreparedTask& prepared_;
    const StatePacker& packer_;
    std::mutex mutex_;
    KnownPossible possible_;
    KnownMoves moves_;
    std::unordered_map<std::string, std::shared_ptr<const Tour>> tours_;
    std::size_t bytes_ = 0;

    std::shared_ptr<const Tour> tour(const Question& question);
    std::optional<std::vector<OperatorId>> descend(const Question& question, const Tour& tour, std::int64_t max_evaluations) const;
    std::optional<std::vector<OperatorId>> search_within_bound(const Question& question, const Tour& tour, std::int64_t max_evaluations) const;
};

}  // namespace explicable
