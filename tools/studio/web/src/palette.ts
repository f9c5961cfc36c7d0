// Colours that tell things apart where nothing else names them: lines of plots, laser fans, trails.
export const palette = ['#3a7be0', '#3aa655', '#e08a2a', '#b455c8', '#22a7a7', '#d6506a', '#8a8f2a', '#7a6ae0'];
