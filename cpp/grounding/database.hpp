// All atoms that grounding has met: static ones, true for ever, and fluent ones, which are the facts of the task.
#pragma once

#include <cstdint>
#include <vector>

#include "grounding/lifted.hpp"
#include "grounding/relation.hpp"
#include "task/task.hpp"

namespace explicable::grounding {

// A fact is at first only mentioned; it is reached once the delete relaxation makes it true, and processed
// once the schemas that need it have been joined with it. Static rows are always in the indexes.
class Database {
public:
    explicit Database(const LiftedTask& task) : task_(task), facts_of_(task.arity.size()) {
        for (const std::int32_t arity : task.arity) relations_.emplace_back(arity, task.num_objects);
        for (std::size_t p = 0; p < relations_.size(); ++p)
            for (std::int32_t i = 0; i < task.num_initial[p]; ++i) {
                const std::int32_t* arguments = task.initial[p].data() + std::size_t(i) * task.arity[p];
                if (task.fluent[p])
                    intern(static_cast<std::int32_t>(p), arguments);
                else
                    relations_[p].insert(arguments);
            }
        num_initial_ = num_facts();
    }

    // To be called once, when all indexes that will ever be asked for have been made.
    void index_static_rows() {
        for (std::size_t p = 0; p < relations_.size(); ++p)
            if (!task_.fluent[p])
                for (RowId row = 0; row < relations_[p].size(); ++row) relations_[p].index_row(row);
    }

    const LiftedTask& task() const { return task_; }
    Relation& relation(std::int32_t predicate) { return relations_[predicate]; }
    const Relation& relation(std::int32_t predicate) const { return relations_[predicate]; }
    bool is_fluent(std::int32_t predicate) const { return task_.fluent[predicate]; }

    FactId intern(std::int32_t predicate, const std::int32_t* arguments) {
        const auto [row, is_new] = relations_[predicate].insert(arguments);
        if (!is_new) return facts_of_[predicate][row];
        const FactId fact = num_facts();
        facts_of_[predicate].push_back(fact);
        predicate_.push_back(predicate);
        row_.push_back(row);
        reached_.push_back(0);
        processed_.push_back(0);
        return fact;
    }
    FactId fact_of(std::int32_t predicate, RowId row) const { return facts_of_[predicate][row]; }
    std::int32_t predicate_of(FactId fact) const { return predicate_[fact]; }
    const std::int32_t* arguments_of(FactId fact) const { return relations_[predicate_[fact]].row(row_[fact]); }

    std::int32_t num_facts() const { return static_cast<std::int32_t>(predicate_.size()); }
    std::int32_t num_initial() const { return num_initial_; }  // the facts below it are true at the start

    bool is_reached(FactId fact) const { return reached_[fact]; }
    bool is_processed(FactId fact) const { return processed_[fact]; }
    void mark_reached(FactId fact) { reached_[fact] = 1; }
    void mark_processed(FactId fact) {
        processed_[fact] = 1;
        relations_[predicate_[fact]].index_row(row_[fact]);
    }

    std::size_t memory_bytes() const {
        std::size_t bytes = predicate_.capacity() * 14;
        for (const Relation& relation : relations_) bytes += relation.memory_bytes();
        return bytes;
    }

private:
    const LiftedTask& task_;
    std::vector<Relation> relations_;
    std::vector<std::vector<FactId>> facts_of_;  // [predicate][row]
    std::vector<std::int32_t> predicate_;
    std::vector<RowId> row_;
    std::vector<std::uint8_t> reached_, processed_;
    std::int32_t num_initial_ = 0;
};

}  // namespace explicable::grounding
