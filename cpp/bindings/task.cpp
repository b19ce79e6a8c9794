#include "bindings/bindings.hpp"

void bind_task(nb::module_&) {}
