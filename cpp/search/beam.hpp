// Beam search for a plan of lower J: of all paths of one length only the most promising are gone on with.
#pragma once

#include "search/engine.hpp"
#include "search/improve.hpp"
#include "search/node_store.hpp"
#include "search/outlook.hpp"

namespace explicable {

// Offers all plans that it comes by; a path's promise is its J so far and what lies ahead at the least. False if the monitor stopped.
bool search_beam(const Question& question, Closing closing, const Outlook& outlook, std::size_t width, Monitor& monitor,
                 Incumbent& best);

}  // namespace explicable
