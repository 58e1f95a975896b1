# The notices of what is compiled in, gathered into one file that travels with the wheel.
function(rdpm_leading_comment file result)
  file(READ "${file}" text)
  string(FIND "${text}" "#ifndef" end)
  string(SUBSTRING "${text}" 0 ${end} comment)
  set(${result} "${comment}" PARENT_SCOPE)
endfunction()

function(rdpm_write_notices target_file)
  rdpm_leading_comment("${ducc0_include}/ducc0/fft/fft.h" ducc0_notice)
  execute_process(
    COMMAND "${Python_EXECUTABLE}" -c
            "import importlib.metadata as m; print(next(f.read_text() for f in m.files('nanobind') if f.name == 'LICENSE'))"
    OUTPUT_VARIABLE nanobind_notice COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE robin_map "${nanobind_ROOT}/../ext/*/robin_map.h")
  set(robin_map_notice "")
  foreach(header IN LISTS robin_map)
    rdpm_leading_comment("${header}" robin_map_notice)
  endforeach()
  file(WRITE "${target_file}"
       "rdpm's extension module contains code of these projects.\n\n"
       "== ducc0: its FFT files, used under BSD-3-Clause\n\n${ducc0_notice}\n"
       "== nanobind\n\n${nanobind_notice}\n"
       "== robin_map, within nanobind\n\n${robin_map_notice}\n")
endfunction()
