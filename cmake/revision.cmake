# The commit that is built, for the provenance of results.
find_package(Git QUIET)
set(MASTIC_REVISION "unknown revision")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE git_revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(MASTIC_REVISION ${git_revision})
  endif()
endif()
