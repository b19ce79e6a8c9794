// The extension module explicable._core: one submodule-free namespace, one bind_ function per folder of cpp/.
#include "bindings/bindings.hpp"

NB_MODULE(_core, module) {
    module.doc() = "Compiled core of explicable: grounding, search and sequence labelling.";
    bind_task(module);
    bind_search(module);
    bind_labelling(module);
    bind_scorer(module);
}
