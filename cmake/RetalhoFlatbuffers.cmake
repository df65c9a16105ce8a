# FlatBuffers, the container of model files: the C++ reader and writer are made from the schema at build time, by the
# flatc of the same package as the headers, into the build folder. Nothing generated is kept in the repository.
find_program(FLATC_PROGRAM flatc REQUIRED)
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)  # used as a header: no library to link

include(GNUInstallDirs)

# retalho_flatbuffers(TARGET SCHEMA): installs the schema as share/retalho/<name>.fbs and generates
# <name>_generated.h for TARGET's sources to include as "retalho/<room>/<name>_generated.h".
function(retalho_flatbuffers target schema)
  get_filename_component(name "${schema}" NAME_WE)
  get_filename_component(folder "${schema}" DIRECTORY)
  file(RELATIVE_PATH folder "${CMAKE_CURRENT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}/${folder}")
  set(output_folder "${CMAKE_CURRENT_BINARY_DIR}/generated/${folder}")
  set(output "${output_folder}/${name}_generated.h")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${FLATC_PROGRAM}" --cpp --scoped-enums -o "${output_folder}" "${CMAKE_CURRENT_SOURCE_DIR}/${schema}"
    DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${schema}"
    COMMENT "flatc ${schema}"
    VERBATIM)
  install(FILES "${schema}" DESTINATION "${CMAKE_INSTALL_DATADIR}/retalho")
  target_sources(${target} PRIVATE "${output}")
  target_include_directories(${target} SYSTEM PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/generated"
                             "${FLATBUFFERS_INCLUDE_DIR}" "${XXHASH_INCLUDE_DIR}")
endfunction()
