# Fetches the plotting library by npm, at the version in the lock file, to OUT; where npm is missing or cannot reach its
# registry, OUT says in each plot's place what is missing. cmake -DNPM=... -DWEB=... -DBINARY=... -DOUT=... -P fetch_plotly.cmake
set(library ${BINARY}/node_modules/plotly.js-gl3d-dist-min/plotly-gl3d.min.js)
set(result "npm was not found")
if(NPM)
  file(COPY ${WEB}/package.json ${WEB}/package-lock.json DESTINATION ${BINARY})
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --loglevel=error WORKING_DIRECTORY ${BINARY}
    RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE said TIMEOUT 300)
endif()
if(result EQUAL 0 AND EXISTS ${library})
  file(COPY_FILE ${library} ${OUT})
else()
  message(WARNING "The plotting library of the reports could not be fetched (npm ci: ${result}): reports will say that their "
    "plots need it. Give -DTOUCHSTONE_PLOTLY=<plotly-gl3d.min.js>, or set npm's own proxy or cafile.\n${said}")
  file(COPY_FILE ${WEB}/plots-missing.js ${OUT})
endif()
file(TOUCH ${OUT})
