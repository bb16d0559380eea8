# One name for deal.II: project_dealii. Its own set-up macro uses the link signature without
# keywords and a C++17 flag.
find_package(deal.II 9.4 REQUIRED)
include(${DEAL_II_TARGET_CONFIG})
add_library(project_dealii INTERFACE)
target_include_directories(project_dealii SYSTEM INTERFACE ${DEAL_II_INCLUDE_DIRS})
target_link_libraries(project_dealii INTERFACE
  $<IF:$<CONFIG:Debug>,${DEAL_II_TARGET_DEBUG},${DEAL_II_TARGET_RELEASE}>)
target_compile_definitions(project_dealii INTERFACE $<$<CONFIG:Debug>:DEBUG>)
