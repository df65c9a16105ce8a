# The model file's schema once more, with tables that can be taken apart, changed and put together again: for tests of
# what reading makes of a file that is whole and wrong. In a namespace of its own, beside the library's.
set(schema "${PROJECT_SOURCE_DIR}/src/retalho/model/model_file.fbs")
set(parts "${CMAKE_CURRENT_BINARY_DIR}/model_parts/model_parts")
file(READ "${schema}" text)
string(REPLACE "namespace retalho.model_file;" "namespace retalho.model_parts;" text "${text}")
file(CONFIGURE OUTPUT "${parts}.fbs" CONTENT "${text}" @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${schema}")
get_filename_component(folder "${parts}" DIRECTORY)
add_custom_command(
  OUTPUT "${parts}_generated.h"
  COMMAND "${FLATC_PROGRAM}" --cpp --scoped-enums --gen-object-api -o "${folder}" "${parts}.fbs"
  DEPENDS "${parts}.fbs"
  COMMENT "flatc ${parts}.fbs"
  VERBATIM)
target_sources(test_model PRIVATE "${parts}_generated.h")
target_include_directories(test_model SYSTEM PRIVATE "${folder}" "${FLATBUFFERS_INCLUDE_DIR}" "${XXHASH_INCLUDE_DIR}")
