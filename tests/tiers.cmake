# Which tests run when, read by CTest: `ctest -L quick` takes under two minutes in all on two cores; `-L full` is every
# test but the nightly ones, what script/test runs; `-L nightly` is what .ci/nightly runs besides. A suite that is named
# here is not quick: it takes longer than a second or two.
set(slow_suites)
set(nightly_suites)

# The labels of a suite of GoogleTest. CTest knows no IN_LIST.
function(tier_labels suite result)
  list(FIND nightly_suites "${suite}" nightly)
  list(FIND slow_suites "${suite}" slow)
  if(NOT nightly EQUAL -1)
    set(labels nightly)
  elseif(NOT slow EQUAL -1)
    set(labels full)
  else()
    set(labels quick full)
  endif()
  set(${result} "${labels}" PARENT_SCOPE)
endfunction()
