// Everything has been declared: draw what the address asks for.
"use strict";

report.state.start();
