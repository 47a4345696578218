// The form of options: a row for each option of /v1/methods. It shows what the chosen preset sets,
// and gives what differs from that.
const FIRST = ["preset", "method", "lambda", "guarantee", "max_distortion", "resolution", "padding"];

export const $ = (id) => document.getElementById(id);

let methods;  // the answer of /v1/methods

function makeInput(option) {
  if (option.words)
    return Object.assign(document.createElement("input"), { value: option.default, size: 8 });
  if (!option.enum) {
    const kind = option.type === "boolean" ? "checkbox" : "number";
    const input = Object.assign(document.createElement("input"), { type: kind });
    if (kind === "checkbox") return Object.assign(input, { checked: option.default });
    const { minimum = "", maximum = "" } = option;
    return Object.assign(input, { min: minimum, max: maximum, value: option.default ?? "",
      step: option.type === "integer" ? 1 : "any" });
  }
  const select = document.createElement("select");
  for (const value of option.enum) select.add(new Option(value, value, false, value === option.default));
  return select;
}

function addRow(option) {
  const row = document.createElement("label");
  const hint = document.createElement("small");
  hint.textContent = option.description;
  const input = Object.assign(makeInput(option), { name: option.name });
  row.append(option.name, " ", input, hint);
  $(FIRST.includes(option.name) ? "options" : "more").append(row);
}

/** The rows of what the chosen method has. */
function showWhatCounts() {
  const method = methods.methods.find(({ name }) => name === $("form").elements.method.value);
  for (const row of document.querySelectorAll(".options label")) {
    const input = row.querySelector("[name]");
    row.hidden = input.disabled = !method.options.includes(input.name);
    if (input.name === "method") row.querySelector("small").textContent = method.description;
  }
}

function valueOf(option, input) {
  if (option.type === "boolean") return input.checked;
  if (option.enum || option.words?.includes(input.value)) return input.value;
  return input.value === "" ? null : Number(input.value);
}

/** What the chosen preset sets. */
function defaultOf(option) {
  const { options } = methods.presets.find(({ name }) => name === $("form").elements.preset.value);
  const set = option.name.split(".").reduce((at, name) => at?.[name], options);
  return set === undefined ? option.default : set;
}

/** Shows the values of the chosen preset. */
function showPreset() {
  const { elements } = $("form");
  for (const option of methods.options) {
    const input = elements[option.name];
    if (!input || option.name === "preset") continue;
    if (option.type === "boolean") input.checked = defaultOf(option);
    else input.value = defaultOf(option) ?? "";
  }
}

/** What differs from the preset, nested as the API has it: {"stop": {"iterations": 10}}. */
export function chosenOptions() {
  const options = {};
  for (const option of methods.options) {
    const input = $("form").elements[option.name];
    if (!input || input.disabled) continue;
    const value = valueOf(option, input);
    const usual = option.name === "preset" ? option.default : defaultOf(option);
    if (value === usual || (value === null && typeof usual !== "number")) continue;
    const path = option.name.split(".");
    const last = path.pop();
    path.reduce((at, name) => (at[name] ??= {}), options)[last] = value;
  }
  return options;
}

/** Makes the rows; answer: of /v1/methods. */
export function buildForm(answer) {
  methods = answer;
  methods.options.filter(({ type }) => type !== "array").forEach(addRow);
  $("form").elements.method.addEventListener("change", showWhatCounts);
  $("form").elements.preset.addEventListener("change", showPreset);
  showWhatCounts();
}
