"""Types of the compiled core; one section per file of ``cpp/bindings``."""

# --- task and grounding (cpp/bindings/task.cpp) ---

# --- search (cpp/bindings/search.cpp) ---

# --- labelling (cpp/bindings/labelling.cpp) ---
