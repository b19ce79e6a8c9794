// What the features of a step see of a team task, as flat arrays: who acts, what a human step asks for, and how far
// every step is from every target, in the robot's own model and in the mental model (docs/labelling.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "task/task.hpp"

namespace explicable {

using Distance = std::uint16_t;
inline constexpr Distance kNoWay = 0xFFFF;
inline constexpr int kMaxTourGoals = 10;  // with more open goals than this no best order is looked for

enum class Model : int { kMental = 0, kOwn = 1 };

// How a step changes the distance to a target; the order is that of `PROGRESS` in features.py.
enum class Progress : std::uint8_t {
    kNoTarget,
    kUnconcerned,
    kNearer,
    kSame,
    kFarther,
    kMuchFarther,
    kNoWay,
    kShortcut,
    kDone,
    kDoneOther,
};
inline constexpr int kNumProgress = 10;

// The composite task's numbering in terms of the mental task's; -1: the mental task has no such thing.
struct MentalNames {
    std::vector<std::int32_t> schema, predicate, object;
};

class TeamTables {
public:
    // `goal`: facts of the composite task; `is_human`: one flag an object of it. Throws std::invalid_argument if sizes do not fit, and
    // std::length_error if the table of distances would exceed `kMaxDistances` entries.
    TeamTables(const Task& composite, const Task& mental, const std::vector<FactId>& goal, const MentalNames& names,
               const std::vector<std::uint8_t>& is_human);

    static constexpr std::size_t kMaxDistances = std::size_t{1} << 28;

    std::int32_t num_operators() const { return static_cast<std::int32_t>(schema.size()); }
    int num_requests() const { return static_cast<int>(request_facts.size()); }
    int num_goals() const { return static_cast<int>(goals.size()); }

    // Progress of a robot's step toward what request `request` asks for.
    Progress toward_request(Model model, OperatorId step, int request) const;
    // Progress toward the nearest open goal; `closed` has kNoWay for a goal that is fulfilled, 0 for an open one.
    Progress toward_nearest_goal(Model model, OperatorId step, std::span<const Distance> closed) const;
    // Progress along the best order of all open goals in the mental model; toward the nearest if they are too many.
    Progress toward_mission(OperatorId step, std::span<const Distance> closed) const;
    // Whether an earlier step, or -1 for none, had deleted all that `step` adds.
    bool takes_back(OperatorId step, OperatorId earlier) const;

    std::vector<std::int32_t> schema;     // of an operator
    std::vector<std::uint8_t> is_human;   // the operator is a human's
    std::vector<std::uint8_t> in_mental;  // the mental task has it
    int num_schemas = 0, max_arity = 0;
    std::vector<std::int32_t> arguments;  // max_arity an operator, -1 where it has fewer
    Table<FactId> adds, deletes;
    std::vector<FactId> request_facts;   // the fact that a request adds
    std::vector<std::int32_t> asks_for;  // request of a human operator, or -1
    Table<std::int32_t> fulfils;         // requests that a robot's operator fulfils
    std::vector<FactId> goals;
    Table<std::int32_t> achieves;  // goals that an operator adds

private:
    void find_requests(const Task& task);
    void find_goals(const Task& task);
    void measure(const Task& composite, const Task& mental, const std::vector<FactId>& mental_fact,
                 const std::vector<std::uint8_t>& mental_human);
    void find_places(const Task& task);
    void find_tours(const Task& task);

    std::size_t num_targets() const { return request_facts.size() + goals.size(); }
    const Distance* row(FactId fact, Model model) const {
        return distances_.data() + (2 * static_cast<std::size_t>(fact) + static_cast<std::size_t>(model)) * num_targets();
    }
    Distance nearest_target(std::span<const FactId> facts, Model model, std::size_t target) const;
    Distance nearest_goal(std::span<const FactId> facts, Model model, std::span<const Distance> closed) const;
    Distance mission(std::span<const FactId> facts, std::size_t open) const;
    bool achieves_open_goal(OperatorId step, std::span<const Distance> closed) const;

    std::vector<Distance> distances_;  // fact x model x (requests, then goals)
    // A step leads from its sources to its sinks; facts from which no target can be reached are left out.
    Table<FactId> sources_, sinks_;
    std::vector<Distance> tours_;  // open goals (bits) x first goal: steps for the others, in the best order
};

}  // namespace explicable
