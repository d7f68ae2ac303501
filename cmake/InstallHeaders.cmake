# Copies the core's headers from `from` to `to`, with `lightfit/` before the rooms in their #include
# lines. Run by `cmake --install`.
foreach(room base geometry optimizer partition)
  file(GLOB_RECURSE headers RELATIVE ${from} ${from}/${room}/*.h)
  # Other people's plans are there to be compared with, and no engine links them.
  list(FILTER headers EXCLUDE REGEX "^partition/(published|shipped)/")
  foreach(header ${headers})
    file(READ ${from}/${header} text)
    string(REGEX REPLACE "#include \"(base|geometry|optimizer|partition)/" "#include \"lightfit/\\1/" text
      "${text}")
    get_filename_component(folder ${to}/${header} DIRECTORY)
    file(MAKE_DIRECTORY ${folder})
    file(CONFIGURE OUTPUT ${to}/${header} CONTENT "@text@" @ONLY)
    list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${to}/${header})
  endforeach()
endforeach()
