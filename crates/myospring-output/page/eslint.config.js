import js from "@eslint/js";
import globals from "globals";

export default [
  { ignores: ["node_modules", "shots", "vendor"] },
  js.configs.recommended,
  {
    files: ["src/**/*.js"],
    languageOptions: { globals: globals.browser },
  },
  {
    // Tests run in Node and hand functions to the browser.
    files: ["*.js", "test/**/*.js"],
    languageOptions: { globals: { ...globals.node, ...globals.browser } },
  },
  {
    rules: {
      eqeqeq: "error",
      "no-var": "error",
      "prefer-const": "error",
      "no-console": "error",
      // Types are checked by tsc.
      "no-undef": "off",
    },
  },
];
