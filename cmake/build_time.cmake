# SPDX-License-Identifier: Apache-2.0
# What makes builds shorter for scripts/test: headers read once, and of the tests those alone that will run.

# Compilers spend more than half of their time in the same headers. Launchers like ccache keep whole objects
# instead, and most of them cannot with precompiled headers.
if(RELUMINE_PRECOMPILE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(headers <algorithm> <array> <bit> <charconv> <cmath> <cstdint> <cstring> <filesystem> <functional> <limits> <map>
        <memory> <mutex> <numeric> <optional> <span> <string> <string_view> <variant> <vector> <fmt/format.h>)
    target_precompile_headers(relumine PRIVATE ${headers})
    if(RELUMINE_FUZZ)
        target_precompile_headers(relumine_fuzzed PRIVATE ${headers})
    endif()
    if(RELUMINE_BUILD_TESTS)
        target_precompile_headers(relumine_tests PRIVATE ${headers} <gtest/gtest.h> <nlohmann/json.hpp>)
    endif()
endif()

# Files without "_test" are helpers, which any of them may need.
if(RELUMINE_BUILD_TESTS AND RELUMINE_TEST_FILES)
    get_target_property(sources relumine_tests SOURCES)
    set(kept ${sources})
    list(FILTER kept INCLUDE REGEX "${RELUMINE_TEST_FILES}")
    list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
    list(APPEND sources ${kept})
    list(REMOVE_DUPLICATES sources)
    set_target_properties(relumine_tests PROPERTIES SOURCES "${sources}")
endif()
